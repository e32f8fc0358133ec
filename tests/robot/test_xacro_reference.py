"""Documents are rendered as the `xacro` package renders them."""

import xml.etree.ElementTree as ET

import pytest
import xacro

from harness.core.errors import SpecError
from harness.core.resources import data_folder
from harness.plugins.formats.xacro.render import render
from harness.robot.load import robot_names
from harness.robot.packages import PackagePath

NAMESPACE = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'
FILES = {
    "limbs.xacro": f"""<robot {NAMESPACE}>
      <xacro:property name="width" value="0.3"/>
      <xacro:macro name="limb" params="name width:=^|0.1 *origin **more">
        <limb name="${{name}}" width="${{width}}"><xacro:insert_block name="origin"/>
          <xacro:insert_block name="more"/></limb>
      </xacro:macro>
    </robot>""",
    "sizes.yaml": """
      joints: {elbow: {max: !degrees 150.0, min: !radians -pi / 2}, wrist: {max: 010}}
      far: [1, 2.5, 1e3, 1.0e3, yes, off, ~, 1:30, 1_000, 0x1F, "7"]
      base: &base {a: 1, b: 2}
      more: {<<: *base, b: 3}
      twice: 1
      twice: 2
    """,
}
BODIES = {
    "literals of properties": """
      <xacro:property name="a" value="1"/><xacro:property name="b" value="1.50"/>
      <xacro:property name="c" value="'1'"/><xacro:property name="d" value="true"/>
      <xacro:property name="e" value="1_000"/><xacro:property name="f" value=" 2 "/>
      <xacro:property name="g" value="1e3"/><xacro:property name="h" value="nan"/>
      <x v="${a} ${b} ${c} ${d} ${e} ${f} ${g} ${h} ${a + b} ${c + 1} ${not d}"/>
    """,
    "lazy and greedy properties": """
      <xacro:property name="a" value="${b}x"/><xacro:property name="b" value="1"/>
      <xacro:property name="c" value="${b}x" lazy_eval="false"/>
      <xacro:property name="b" value="2"/><x a="${a}" c="${c}"/>
    """,
    "defaults and removals": """
      <xacro:property name="a" default="1"/><xacro:property name="a" default="2"/><x a="${a}"/>
      <xacro:property name="a" remove="true"/><xacro:property name="a" default="3"/><x a="${a}"/>
    """,
    "scopes": """
      <xacro:macro name="inner">
        <xacro:property name="a" value="in" scope="parent"/>
        <xacro:property name="b" value="${1 + 1}" scope="global"/>
        <xacro:property name="c" value="own"/><x c="${c}"/>
      </xacro:macro>
      <xacro:macro name="outer"><xacro:inner/><x a="${a}" b="${b}"/></xacro:macro>
      <xacro:property name="a" value="top"/><xacro:outer/><x a="${a}" b="${b}"/>
    """,
    "defaults of parameters": """
      <xacro:property name="q" value="7"/><xacro:property name="s" value="9"/>
      <xacro:macro name="m" params="a b:=2 c=${q + 1} d:='x y' e:=^ f:=^|5 s:=^|6 g:=${' '}">
        <x a="${a}" b="${b}" c="${c}" d="${d}" e="${e}" f="${f}" s="${s}" g="${g}"/>
      </xacro:macro>
      <xacro:property name="e" value="of the caller"/>
      <xacro:m a="1"/><xacro:m a="${q}" b="${[1, 2]}" f="$(arg high)" s="0"/>
    """,
    "blocks": """
      <xacro:macro name="m" params="*first **rest name">
        <y name="${name}"><xacro:insert_block name="first"/></y>
        <z><xacro:insert_block name="rest"/><xacro:insert_block name="rest"/></z>
      </xacro:macro>
      <xacro:property name="v" value="4"/>
      <xacro:m name="n"><one v="${v}">text ${v}</one><two><a/>mixed ${v}<b/></two></xacro:m>
      <xacro:property name="block"><c v="${v}"/><d/></xacro:property>
      <e><xacro:insert_block name="block"/></e>
    """,
    "conditions": """
      <xacro:if value="1"><a/></xacro:if><xacro:unless value="${1 > 2}"><b/></xacro:unless>
      <xacro:if value="$(arg flag)"><c/></xacro:if><xacro:if value="${'false'}"><d/></xacro:if>
      <xacro:if value="${[]}"><e/></xacro:if><xacro:if value="${0.5}"><f/></xacro:if>
    """,
    "calls, elements and attributes by name": """
      <xacro:macro name="m_a" params="v"><x v="${v}"/></xacro:macro>
      <xacro:property name="which" value="a"/><xacro:call macro="m_${which}" v="1"/>
      <xacro:element xacro:name="y_${which}" w="2"><z/></xacro:element>
      <u><xacro:attribute name="w_${which}" value="text ${which}"/></u>
      <w><xacro:if value="1"><xacro:attribute name="lost" value="x"/></xacro:if></w>
    """,
    "macros in macros": """
      <xacro:macro name="count" params="items">
        <xacro:if value="${items}">
          <x v="${items[0]}"/><xacro:count items="${items[1:]}"/>
        </xacro:if>
      </xacro:macro>
      <xacro:count items="${list(range(5))}"/>
      <xacro:macro name="define"><xacro:macro name="local"><l/></xacro:macro><xacro:local/>
      </xacro:macro><xacro:define/>
    """,
    "includes": """
      <xacro:include filename="limbs.xacro"/><xacro:limb name="a"><o/><m><n/></m></xacro:limb>
      <x w="${width}"/><xacro:include filename="gone.xacro" optional="true"/>
      <xacro:include filename="limb*.xacro"/><xacro:include filename="**mbs.xacro"/>
      <xacro:include filename="l**.xacro"/>
    """,
    "includes with a namespace": """
      <xacro:property name="width" value="0.9"/><xacro:include filename="limbs.xacro" ns="lib"/>
      <x w="${width} ${lib.width}"/><xacro:lib.limb name="a"><o/><m/></xacro:lib.limb>
    """,
    "YAML": """
      <xacro:property name="sizes" value="${xacro.load_yaml('sizes.yaml')}"/>
      <x a="${sizes.joints.elbow.max} ${sizes['joints']['elbow']['min']} ${sizes.joints.wrist.max}"
         b="${sizes.far} ${sizes.more['a']} ${sizes.more.b} ${sizes.twice} ${len(sizes)}"/>
    """,
    "texts": """
      <x a="$${1}" b="$$$(x)" c="$" d="a$b" e="50 $ each" f="${1}${2}" g="-${1}-$(arg high)-"/>
      <y>  ${1 + 1} and $(arg high)  <![CDATA[${kept}]]></y><!-- ${dropped} -->
      <z v="$(eval 1 + 1)" w="$(eval high)" u="$(optenv NOT_SET_ANYWHERE the default)"/>
    """,
    "functions": """
      <x a="${radians(180)} ${math.pi} ${pi} ${sin(pi / 2)} ${round(1.2345, 2)} ${max(1, 2.5)}"
         b="${python.abs(-1)} ${python.sum([1, 2])} ${python.list(python.zip([1], [2]))}"
         c="${xacro.tokenize('a, b;c')} ${xacro.arg('high')} ${xacro.message('x')}"
         d="${'%.3f' % 2.5} ${'a b'.split()[1]} ${' '.join([str(v) for v in [1, 2]])}"
         e="${xacro.dotify(dict(a=dict(b=1))).a.b} ${dict(a=1)} ${(1, 2)} ${True} ${None}"/>
    """,
}
REFUSED = {
    "an unknown macro": "<xacro:gone/>",
    "a macro without its parameter": '<xacro:macro name="m" params="a"/><xacro:m/>',
    "a parameter that is not there": '<xacro:macro name="m"/><xacro:m a="1"/>',
    "a block that lacks": '<xacro:macro name="m" params="*b"/><xacro:m/>',
    "a block too many": '<xacro:macro name="m"/><xacro:m><a/></xacro:m>',
    "an unknown block": '<xacro:insert_block name="b"/>',
    "a condition of text": '<xacro:if value="perhaps"/>',
    "a condition without a value": "<xacro:if/>",
    "a property of two values": '<xacro:property name="a" value="1" default="2"/>',
    "a property of a bad name": '<xacro:property name="a b" value="1"/>',
    "a property named like a word of Python": '<xacro:property name="lambda" value="1"/>',
    "a circle of properties": '<xacro:property name="a" value="${a}"/><x v="${a}"/>',
    "an argument without a default": '<xacro:arg name="new"/>',
    "an argument without a value": '<x v="$(arg new)"/>',
    "an unknown substitution": '<x v="$(new a)"/>',
    "an unknown name": '<x v="${new}"/>',
    "half an expression": '<x v="${1 +}"/>',
    "an expression without an end": '<x v="${1"/>',
    "abs without its namespace": '<x v="${abs(-1)}"/>',
    "a nested substitution": '<x v="$(arg $(arg high))"/>',
    "a default of a parameter": '<xacro:macro name="m" params="a b:=${a}"/><xacro:m a="1"/>',
    "an include of a file that is not there": '<xacro:include filename="gone.xacro"/>',
    "a macro named call": '<xacro:macro name="call"/>',
    "a macro with a dot": '<xacro:macro name="a.b"/>',
}


def written(folder, body):
    for name, text in FILES.items():
        (folder / name).write_text(text)
    path = folder / "arm.xacro"
    arguments = '<xacro:arg name="high" default="0.5"/><xacro:arg name="flag" default="true"/>'
    path.write_text(f"<robot {NAMESPACE}>{arguments}{body}</robot>")
    return path


def of_package(element):
    """An element of the package's document as plain data."""
    text = "".join([element.text or "", *(child.tail or "" for child in element)])
    return (
        element.tag,
        dict(element.attrib),
        " ".join(text.split()),
        [of_package(child) for child in element],
    )


def of_harness(element):
    """A rendered element as plain data."""
    children = [of_harness(child) for child in element.children]
    return element.tag, element.attributes, " ".join(element.text.split()), children


def rendered_by_both(path, args):
    document = ET.fromstring(xacro.process_file(str(path), mappings=dict(args)).toxml())
    return of_package(document), of_harness(render(path, args, PackagePath.of_file(path)))


@pytest.mark.parametrize("title", BODIES)
def test_a_document_is_rendered_as_the_package_does(tmp_path, title):
    path = written(tmp_path, BODIES[title])
    for args in ({}, {"high": "0.25", "flag": "false"}):
        theirs, own = rendered_by_both(path, args)
        assert own == theirs


@pytest.mark.parametrize("title", REFUSED)
def test_what_the_package_refuses_is_refused(tmp_path, title):
    path = written(tmp_path, REFUSED[title])
    with pytest.raises(Exception):  # noqa: B017, PT011 - the package has several kinds
        xacro.process_file(str(path), mappings={})
    with pytest.raises(SpecError) as caught:
        render(path, {}, PackagePath.of_file(path))
    assert caught.value.problems[0].line == 1
    assert caught.value.problems[0].column > 1


@pytest.mark.nightly(but=["ur3e", "ur15"])
@pytest.mark.parametrize("model", [name for name in robot_names() if name.startswith("ur")])
def test_bundled_files_are_rendered_as_the_package_does(model):
    path = data_folder("robots") / "universal_robots/ur.urdf.xacro"
    theirs, own = rendered_by_both(path, {"ur_type": model})
    assert own == theirs
