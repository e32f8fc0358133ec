"""Expressions of xacro files that try to leave the language, or to exhaust the machine."""

from pathlib import Path

import pytest

from harness.core.errors import SpecError
from harness.plugins.formats.xacro.render import render
from harness.robot.packages import PackagePath
from harness.robot.robot_yaml import read_robot_yaml

NAMESPACE = 'xmlns:xacro="http://www.ros.org/wiki/xacro"'

TO_CLASSES = [
    "().__class__.__base__.__subclasses__()",
    "''.__class__.__mro__[1].__subclasses__()",
    "[].__class__",
    "(1).__class__",
    "xacro.__class__",
    "math.__loader__",
    "math.__dict__",
    "math.__spec__.loader.load_module('os')",
    "python.__getattribute__",
    "list.__init_subclass__",
    "len.__self__",
    "len.call.__globals__",
    "len.call",
    "''.join.call.func.__self__",
    "''.format.__self__",
    "xacro.load_yaml.call.__closure__",
    "xacro.load_yaml('sizes.yaml').__class__",
    "xacro.load_yaml('sizes.yaml').__init__.__globals__",
    "xacro.dotify(dict(a=1)).__class__",
    "dict(a=1).a.__class__",
    "[x for x in [1]].gi_frame",
    "(x for x in [1]).gi_frame.f_back.f_builtins",
    "(x for x in [1]).gi_code",
    "[a := 1, a.__class__]",
    "(a := ().__class__)",
    "[[].append for b in [1]][0].__self__",
    "[().__class__ for x in [1]]",
    "[x for x.y in [1]]",
    "[x for x[0] in [[1]]]",
    "[x async for x in [1]]",
    "(lambda: 1)()",
    "(lambda f: f(f))(lambda f: f(f))",
    "(yield)",
    "(await 1)",
    "{().__class__}",
    "().\uff43\uff4c\uff41\uff53\uff53",
    "()._\uff3fclass_\uff3f",
    "\uff45\uff56\uff41\uff4c('1')",
    "f''.__class__",
    "f'a' 'b'",
    "b'a'.hex()",
    "....__class__",
    "1j.__class__",
]
TO_FUNCTIONS = [
    "__builtins__",
    "__import__('os').system('touch made')",
    "eval('1')",
    "exec('1')",
    "compile('1', '', 'eval')",
    "open('made', 'w')",
    "open('/etc/passwd').read()",
    "getattr('', 'join')",
    "python.getattr('', '__class__')",
    "setattr(math, 'pi', 3)",
    "globals()",
    "locals()",
    "vars()",
    "python.vars(python.type)",
    "python.type('')",
    "python.type('', (), dict())",
    "python.vars(python.type)['__subclasses__'](python.type('').mro()[1])",
    "python.isinstance(1, int)",
    "python.hash('a')",
    "breakpoint()",
    "input()",
    "help()",
    "print(1)",
    "super()",
    "classmethod(len)",
    "property(len)",
    "os.system('id')",
    "sys.modules",
    "math.os",
    "xacro.os",
    "xacro.eval_text('1')",
    "'a'.encode()",
    "'a'.translate(dict())",
    "'a'.format_map(dict())",
    "[1].append(2)",
    "[1].sort()",
    "dict(a=1).update(b=2)",
    "map(open, ['made'])",
    "map(eval, ['1'])",
    "sorted([1, 2], key=len)",
    "len(*[[1]])",
    "dict(**dict(a=1))",
    "len(len)",
    "[len]",
    "len == len",
    "str(math)",
    "str(len)",
    "'%s' % len",
    "''.join",
    "math",
    "1()",
    "'a'()",
]
THROUGH_FORMATS = [
    "left.__class__ + right",
    "left0.__class__right",
    "left0.__class__.__init__.__globals__right",
    "left0[0]right",
    "leftname.real!rright",
    "left0:left1rightright",
]
EXHAUSTING = [
    "9**9**9",
    "9**9**9**9**9",
    "(-9)**(10**9)",
    "2**4097",
    "1 << 10**9",
    "math.factorial(10**7)",
    "math.comb(10**7, 10**6)",
    "math.perm(10**6, 10**5)",
    "math.prod([2**4000] * 9000)",
    "round(5, -10**9)",
    "'a' * 10**9",
    "10**9 * 'a'",
    "[0] * 10**9",
    "(0,) * 10**9",
    "list(range(10**9))",
    "range(10**30)",
    "python.sum(range(10**9))",
    "[[0] * 9999 for i in range(9999)]",
    "[[[0 for i in range(9999)] for j in range(9999)] for k in range(9999)]",
    "map(list, [range(9999)] * 9999)",
    "str([[[0] * 999] * 999] * 999)",
    "[[[0] * 999] * 999] * 999 == [[[0] * 999] * 999] * 999",
    "len([[[0] * 999] * 999] * 999)",
    "'%1000000000d' % 1",
    "'%.1000000000f' % 1",
    "'%*d' % (10**9, 1)",
    "'%(a)1000000000d' % dict(a=1)",
    "'%(a(b)c)1000000000d' % dict(a=1)",
    "('%(a)s' * 10000) % dict(a='b' * 90000)",
    "'a'.ljust(10**9)",
    "'a'.zfill(10**9)",
    "'a'.center(10**9, 'b')",
    "('a' * 90000).replace('a', 'b' * 90000)",
    "('a' * 90000).replace('', 'b' * 90000)",
    "('a' * 90000).join(['b'] * 9000)",
    "('a' * 90000).join('b' * 9000)",
    "xacro.tokenize('a' * 90000, 'a', False)",
    "+" * 3000 + "1",
    "(" * 1000 + "1" + ")" * 1000,
    "[" * 150 + "]" * 150 + "[0]" * 160,
    "1" * 5000,
    "1" * 3000,
    " + ".join(["1"] * 1900),
]


def write(folder: Path, value: str, content: str = "") -> Path:
    escaped = value.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;")
    path = folder / "arm.xacro"
    path.write_text(
        f'<robot name="arm" {NAMESPACE}>{content}<link name="{escaped}"/></robot>', encoding="utf-8"
    )
    (folder / "sizes.yaml").write_text("far: 0.4\n")
    return path


def refused(folder: Path, value: str, content: str = "") -> str:
    """The message on a file with this value; it has its place, and nothing was made or started."""
    path = write(folder, value, content)
    with pytest.raises(SpecError) as caught:
        render(path, {}, PackagePath.of_file(path))
    problem = caught.value.problems[0]
    assert problem.line >= 1
    assert problem.column >= 1
    assert not (folder / "made").exists()
    assert not Path("made").exists()
    assert "root:" not in str(caught.value)
    return str(caught.value)


@pytest.mark.parametrize("expression", [*TO_CLASSES, *TO_FUNCTIONS])
def test_an_escape_has_no_value(tmp_path, expression):
    refused(tmp_path, f"${{{expression}}}")


@pytest.mark.parametrize("expression", ["'\\x00'", "'\\ud800'", "'\\x1b[2J'", "['\\uffff'][0]"])
def test_a_character_that_no_xml_file_has_is_located(tmp_path, expression):
    """Neither a reader of URDF nor a terminal can take it."""
    assert "XML has no character U+" in refused(tmp_path, f"a${{{expression}}}")
    content = '<xacro:macro name="m" params="v"><a b="${v}"/></xacro:macro>'
    refused(tmp_path, "b", f'{content}<xacro:m v="${{{expression}}}"/>')


@pytest.mark.parametrize("expression", ["().__class__", "__import__('os'", "math.__loader__"])
def test_an_escape_in_a_substitution_has_no_value(tmp_path, expression):
    refused(tmp_path, f"$(eval {expression})")


@pytest.mark.parametrize("template", THROUGH_FORMATS)
def test_a_format_reaches_no_attribute(tmp_path, template):
    """Braces cannot stand in an expression, but a property may hold them."""
    template = template.replace("left", "{").replace("right", "}")
    content = f'<xacro:property name="template" value="\'{template}\'"/>'
    refused(tmp_path, "${template.format(1, [2], name=3)}", content)


@pytest.mark.nightly(only=[18, 20, 21, 22])
@pytest.mark.parametrize("expression", EXHAUSTING)
def test_what_would_exhaust_the_machine_is_refused(tmp_path, expression):
    refused(tmp_path, f"${{{expression}}}")


PROPERTY = '<xacro:property name="p{}" value="{}"/>'
CONTENT = {
    "text that doubles": [
        PROPERTY.format(0, "abcdefgh"),
        *(PROPERTY.format(n, f"${{p{n - 1}}}${{p{n - 1}}}") for n in range(1, 40)),
        '<link name="${p39}"/>',
    ],
    "lists that double": [
        PROPERTY.format(0, "${[1, 2]}"),
        *(PROPERTY.format(n, f"${{[p{n - 1}, p{n - 1}]}}") for n in range(1, 60)),
        '<link name="${p59}"/>',
    ],
    "macros that double": [
        '<xacro:macro name="m0"><link name="a"/></xacro:macro>',
        *(
            f'<xacro:macro name="m{n}"><xacro:m{n - 1}/><xacro:m{n - 1}/></xacro:macro>'
            for n in range(1, 60)
        ),
        "<xacro:m59/>",
    ],
    "a macro that calls itself": [
        '<xacro:macro name="m"><xacro:m/></xacro:macro>',
        "<xacro:m/>",
    ],
    "a block that inserts itself": [
        '<xacro:macro name="m" params="**b"><xacro:insert_block name="b"/></xacro:macro>',
        '<xacro:property name="b"><xacro:insert_block name="b"/></xacro:property>',
        '<xacro:insert_block name="b"/>',
    ],
    "a property that is itself": [
        PROPERTY.format(0, "${p1}"),
        PROPERTY.format(1, "${p0}"),
        '<link name="${p0}"/>',
    ],
    "a long text of commands": ["<a>" + "$(arg " * 200_000 + "</a>"],
    "a long text of expressions": ['<a b="' + "${1}" * 400_000 + '"/>'],
    "many elements": ["<a b='${1}'/>" * 60_000],
    "files that are read again and again": [
        "<xacro:property name='p' value=\"${xacro.load_yaml('many.yaml')}\" lazy_eval='false'/>"
        * 60
    ],
    "a chain of properties": [
        PROPERTY.format(0, "a"),
        *(PROPERTY.format(n, f"${{p{n - 1}}}b") for n in range(1, 5000)),
        '<link name="${p4999}"/>',
    ],
}


@pytest.mark.nightly(but=["text that doubles", "macros that double", "lists that double"])
@pytest.mark.parametrize("title", CONTENT)
def test_documents_without_an_end_are_refused(tmp_path, title):
    (tmp_path / "many.yaml").write_text("".join(f"key{n}: 1\n" for n in range(30_000)))
    refused(tmp_path, "b", "\n".join(CONTENT[title]))


FILES = {
    "include of a file outside": '<xacro:include filename="/etc/passwd"/>',
    "include with a path upwards": '<xacro:include filename="../../../../../../etc/passwd"/>',
    "include of a link": '<xacro:include filename="link.xacro"/>',
    "include by a wildcard": '<xacro:include filename="/etc/pass*"/>',
    "include by a wildcard in a folder": '<xacro:include filename="/*/passwd"/>',
    "include of a folder": '<xacro:include filename="."/>',
    "include of a device": '<xacro:include filename="/dev/zero"/>',
    "include by a package upwards": '<xacro:include filename="$(find ..)/passwd"/>',
    "include by a package with a path": '<xacro:include filename="$(find ../etc)/passwd"/>',
    "include of itself": '<xacro:include filename="arm.xacro"/>',
    "YAML outside": "<a b=\"${xacro.load_yaml('/etc/passwd')}\"/>",
    "YAML by a link": "<a b=\"${xacro.load_yaml('link.xacro')}\"/>",
    "YAML upwards": "<a b=\"${xacro.load_yaml('../../../../../etc/passwd')}\"/>",
    "YAML of a device": "<a b=\"${xacro.load_yaml('/dev/stdin')}\"/>",
    "YAML with a class": "<a b=\"${xacro.load_yaml('class.yaml')}\"/>",
    "YAML with a module": "<a b=\"${xacro.load_yaml('module.yaml')}\"/>",
    "YAML with an expression in a unit": "<a b=\"${xacro.load_yaml('unit.yaml')}\"/>",
    "YAML with an endless unit": "<a b=\"${xacro.load_yaml('power.yaml')}\"/>",
    "YAML of aliases": "<a b=\"${xacro.load_yaml('aliases.yaml')}\"/>",
    "YAML of brackets": "<a b=\"${xacro.load_yaml('brackets.yaml')}\"/>",
    "include of a long name": f'<xacro:include filename="{"a" * 300}"/>',
    "include of a long path": f'<xacro:include filename="{"a/" * 3000}"/>',
    "a package of a long name": f'<xacro:include filename="$(find {"a" * 300})/b"/>',
    "YAML of a long name": "<a b=\"${xacro.load_yaml('a' * 300)}\"/>",
    "YAML of a number": '<a b="${xacro.load_yaml(5)}"/>',
    "YAML of a name that is none": "<a b=\"${xacro.load_yaml('a\\0b')}\"/>",
    "YAML that is not UTF-8": "<a b=\"${xacro.load_yaml('latin.yaml')}\"/>",
    "the environment": '<a b="$(env HOME)"/>',
    "the current folder": '<a b="$(cwd)"/>',
    "a program": '<a b="$(id)"/>',
    "an entity": "<a b='&file;'/>",
}
YAML = {
    "class.yaml": "a: !!python/object/apply:os.system ['touch made']\n",
    "module.yaml": "a: !!python/name:os.system\n",
    "unit.yaml": "a: !degrees __import__('os').system('touch made')\n",
    "power.yaml": "a: !degrees 9**9**9\n",
    "aliases.yaml": "a0: &a0 [1, 2]\n"
    + "".join(f"a{n}: &a{n} [*a{n - 1}, *a{n - 1}]\n" for n in range(1, 40)),
    "brackets.yaml": "[" * 100_000,
}


@pytest.mark.parametrize("title", FILES)
def test_no_other_file_or_program_is_reached(tmp_path, title):
    for name, text in YAML.items():
        (tmp_path / name).write_text(text)
    (tmp_path / "link.xacro").symlink_to("/etc/passwd")
    (tmp_path / "latin.yaml").write_bytes(b"a: \xe9")
    refused(tmp_path, "b", FILES[title])


@pytest.mark.parametrize("name", ["evil.meshes", "evil.meshes.fine", "..evil", "evil/meshes", ""])
def test_no_module_is_imported_to_look_for_meshes(tmp_path, monkeypatch, name):
    """Python finds `evil.meshes` by importing `evil`."""
    (tmp_path / "evil.py").write_text(f"open({str(tmp_path / 'made')!r}, 'w')")
    monkeypatch.syspath_prepend(tmp_path)
    (tmp_path / "robot.yaml").write_text(
        f"""robot: arm
kind: arm
xacro: {{file: arm.xacro, mesh_arg: meshes, mesh_package: "{name}", mesh_variants: [arm]}}
srdf: arm.srdf
arm_group: arm
tcp_link: tool
"""
    )
    with pytest.raises(SpecError) as caught:
        read_robot_yaml(tmp_path)
    assert "mesh_package" in str(caught.value)
    assert not (tmp_path / "made").exists()


@pytest.mark.parametrize(
    "text", [YAML["brackets.yaml"], YAML["class.yaml"], YAML["aliases.yaml"], "robot: *gone"]
)
def test_a_robot_yaml_is_read_within_bounds(tmp_path, text):
    (tmp_path / "robot.yaml").write_text(text)
    with pytest.raises(SpecError) as caught:
        read_robot_yaml(tmp_path)
    assert caught.value.problems[0].line >= 1
    assert not (tmp_path / "made").exists()


@pytest.mark.parametrize(
    "params", ["a:=" + "x" * 60 + "'", "a:=" + "'x'" * 60 + '"', "a:=${" * 2000]
)
def test_parameters_of_a_macro_are_read_without_long_work(tmp_path, params):
    escaped = params.replace('"', "&quot;")
    refused(tmp_path, "b", f'<xacro:macro name="m" params="{escaped}"/><xacro:m/>')
