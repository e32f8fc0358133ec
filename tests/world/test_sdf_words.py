"""Elements of SDF: those that are read change the world, others are reported."""

import math

import pytest

from harness.core.errors import SpecError
from harness.plugins.formats.sdf.elements import READ as READ_WORDS
from tests.world.sdf_files import BOX, load, text_with


def the(world, name="m"):
    return next(item for item in world.objects if item.name == name)


def names(world):
    return [item.name for item in world.objects]


def xyz(world, name="m"):
    return the(world, name).pose.xyz


def xyz_of_mass(world):
    return the(world).center_of_mass


def shape(world):
    """The first collision of the model."""
    return the(world).shapes[0]


def eye(world):
    return next(camera for camera in world.cameras if camera.name == "eye")


A_MODEL = (
    "<model name='n'><static>1</static><link name='l'><collision name='c'>"
    f"<geometry>{BOX}</geometry></collision></link></model>"
)
AUTO = "' auto='true"
OF_DOORS = ("axis", "limit", "dynamics")
OF_WORLDS = {kind: words for kind, words in READ_WORDS.items() if not kind.startswith("robot")}
"""Those of robots are rows of tests/robot/sdf_format_rows.py."""
DOOR = """<sdf version='1.9'><world name='k'><model name='cabinet'><pose>1 2 3 0 0 0.5</pose>
 <joint name='floor' type='fixed'><parent>world</parent><child>body</child></joint>
 <link name='body'><collision name='c'><geometry><box><size>0.3 0.4 0.4</size></box></geometry>
  </collision></link>
 <link name='door'><pose>-0.2 0.2 0 0 0 0.1</pose>{inertial}<collision name='panel'>
  <pose>0 -0.2 0 0 0 0</pose><geometry><box><size>0.02 0.4 0.4</size></box></geometry></collision>
 </link>
 <joint name='hinge' type='{kind}'><parent>body</parent><child>door</child>
  <axis>{axis}<limit>{limit}</limit><dynamics>{dynamics}</dynamics></axis></joint>
</model>{more}</world></sdf>"""
INERTIAL = """<inertial><mass>1</mass><inertia><ixx>0.02</ixx><iyy>0.01</iyy><izz>0.02</izz>
 </inertia></inertial>"""


def door(folder, **parts):
    """The one joint of a cabinet, and the notes."""
    words = dict.fromkeys(("axis", "limit", "dynamics", "more"), "")
    words |= {"kind": "revolute", "inertial": INERTIAL} | parts
    found = load(folder, DOOR.format(**words))
    (cabinet,) = found.world.objects
    (joint,) = cabinet.joints
    assert (cabinet.name, cabinet.static, len(cabinet.shapes or (cabinet.box,))) == (
        "cabinet",
        True,
        1,
    )
    return joint, [note.message for note in found.notes]


READ = {
    ("sdf", "world"): ("", lambda w: w.world == "w"),
    ("sdf", "model"): None,  # below: a file of models alone
    ("sdf", "light"): None,
    ("world", "model"): (A_MODEL, lambda w: names(w) == ["n", "m", "crate"]),
    ("world", "include"): (
        "<include><name>o</name><uri>model://crate</uri></include>",
        lambda w: names(w) == ["o", "m", "crate"],
    ),
    ("world", "state"): (
        "<state><sim_time>9 0</sim_time><model name='m'><pose>3 0 1.5 0 0 0</pose></model></state>",
        lambda w: xyz(w) == (3, 0, 1.5),
    ),
    ("world", "light"): (
        "<light name='o' type='directional'><direction>1 0 0</direction></light>",
        lambda w: w.lights[0].direction == (1, 0, 0),
    ),
    ("world", "gravity"): ("<gravity>0 0 -1</gravity>", lambda w: w.physics.gravity[2] == -1),
    ("world", "physics"): (
        "<physics default='1'><max_step_size>0.004</max_step_size></physics>",
        lambda w: w.physics.timestep == 0.004,
    ),
    ("world", "frame"): (
        A_MODEL.replace("<static>", "<pose relative_to='f'/><static>")
        + "<frame name='f'><pose>0 3 0 0 0 0</pose></frame>",
        lambda w: xyz(w, "n") == (0, 3, 0),
    ),
    ("world", "joint"): (
        "<joint name='k' type='fixed'><parent>world</parent><child>m</child></joint>",
        lambda w: the(w).static,
    ),
    ("model", "pose"): ("<pose relative_to='cell'>1 2 3 0 0 0</pose>", lambda w: xyz(w)[2] == 3.25),
    ("model", "static"): ("<static>true</static>", lambda w: the(w).static and not the(w).mass),
    ("model", "link"): (
        "<link name='k'><collision name='c'><geometry><sphere><radius>1</radius></sphere>"
        "</geometry></collision></link>",
        lambda w: names(w) == ["m::k", "m::l", "crate"],
    ),
    ("model", "joint"): ("", lambda w: len(the(w).shapes) == 2),
    ("model", "frame"): (
        "<frame name='f'><pose>0 0 7 0 0 0</pose></frame>"
        "<link name='k'><pose relative_to='f'/><collision name='c'><geometry><sphere>"
        "<radius>1</radius></sphere></geometry></collision></link>",
        lambda w: xyz(w, "m::k") == (0, 0, 7),
    ),
    ("model", "model"): (
        A_MODEL.replace("<static>", "<pose>0 5 0 0 0 0</pose><static>"),
        lambda w: xyz(w, "m::n::l") == (0, 5, 0),
    ),
    ("model", "include"): (
        "<include><uri>model://crate</uri></include>",
        lambda w: xyz(w, "m::crate::base") == (1, 0, 0),
    ),
    ("include", "uri"): ("", lambda w: the(w, "crate").sphere.radius == 0.1),
    ("include", "name"): ("<name>o</name>", lambda w: names(w) == ["m", "o"]),
    ("include", "pose"): ("<pose>0 9 0 0 0 0</pose>", lambda w: xyz(w, "crate") == (0, 9, 0)),
    ("include", "static"): ("<static>1</static>", lambda w: the(w, "crate").static),
    ("include", "placement_frame"): (
        "<placement_frame>top</placement_frame><pose>0 0 1 0 0 0</pose>",
        lambda w: xyz(w, "crate") == (0, 0, 0.9),
    ),
    ("link", "pose"): ("<pose>0 0 4 0 0 0</pose>", lambda w: shape(w).pose.xyz == (0, 0, 4)),
    ("link", "inertial"): (
        "",
        lambda w: the(w).mass == 3 and xyz_of_mass(w)[2] == pytest.approx(1 / 3),
    ),
    ("link", "collision"): (
        "<collision name='d'><geometry><sphere><radius>1</radius></sphere></geometry></collision>",
        lambda w: shape(w).sphere.radius == 1,
    ),
    ("link", "visual"): (
        "<visual name='d'><geometry><sphere><radius>1</radius></sphere></geometry></visual>",
        lambda w: the(w).visuals[0].sphere.radius == 1,
    ),
    ("inertial", "mass"): ("<mass>5</mass>", lambda w: the(w).mass == 6),
    ("inertial", "pose"): (
        "<pose>0.3 0 0 0 0 0</pose>",
        lambda w: xyz_of_mass(w)[0] == pytest.approx(0.2),
    ),
    ("inertial", "inertia"): (
        "<inertia><ixx>1</ixx><iyy>1</iyy><izz>1</izz></inertia>",
        lambda w: the(w).inertia.izz == pytest.approx(1.01),
    ),
    ("inertial", "density"): None,  # below: automatic inertia
    ("collision", "pose"): (
        "<pose degrees='true'>0 0 0 0 0 180</pose>",
        lambda w: shape(w).pose.quat_wxyz == pytest.approx((0, 0, 0, 1)),
    ),
    ("collision", "geometry"): ("", lambda w: shape(w).box.size == (0.1, 0.2, 0.3)),
    ("collision", "surface"): ("", lambda w: the(w).shapes[0].friction != the(w).friction),
    ("collision", "density"): None,
    ("visual", "pose"): (
        "<pose>0 0 4 0 0 0</pose>",
        lambda w: the(w).visuals[0].pose.xyz == (0, 0, 4),
    ),
    ("visual", "geometry"): ("", lambda w: the(w).visuals[0].box.size == (0.1, 0.2, 0.3)),
    ("visual", "material"): ("", lambda w: the(w).visuals[0].color == (0, 1, 0, 1)),
    ("visual", "transparency"): (
        "<transparency>0.75</transparency>",
        lambda w: the(w).visuals[0].color == (0, 1, 0, 0.25),
    ),
    ("geometry", "box"): (BOX, lambda w: shape(w).box.size == (0.1, 0.2, 0.3)),
    ("geometry", "cylinder"): (
        "<cylinder><radius>0.1</radius><length>0.5</length></cylinder>",
        lambda w: (shape(w).cylinder.radius, shape(w).cylinder.length) == (0.1, 0.5),
    ),
    ("geometry", "sphere"): (
        "<sphere><radius>0.7</radius></sphere>",
        lambda w: shape(w).sphere.radius == 0.7,
    ),
    ("geometry", "cone"): (
        "<cone><radius>0.1</radius><length>0.5</length></cone>",
        lambda w: shape(w).mesh.scale == (0.1, 0.1, 0.5),
    ),
    ("geometry", "ellipsoid"): (
        "<ellipsoid><radii>0.1 0.2 0.5</radii></ellipsoid>",
        lambda w: shape(w).mesh.scale == (0.1, 0.2, 0.5),
    ),
    ("geometry", "capsule"): (
        "<capsule><radius>0.1</radius><length>0.5</length></capsule>",
        lambda w: (shape(w).capsule.radius, shape(w).capsule.length) == (0.1, 0.5),
    ),
    ("geometry", "plane"): (
        "<plane><normal>1 0 0</normal></plane>",
        lambda w: shape(w).pose.se3().rotation[:, 2] == pytest.approx((1, 0, 0)),
    ),
    ("geometry", "mesh"): (
        "<mesh><uri>part.obj</uri></mesh>",
        lambda w: shape(w).mesh.file.endswith("/part.obj"),
    ),
    ("geometry", "empty"): ("<empty/>", lambda w: the(w).shapes[0].mesh is not None),
    ("mesh", "uri"): ("", lambda w: the(w).shapes[1].mesh.file.endswith("/part.obj")),
    ("mesh", "scale"): (
        "<scale>1 2 3</scale>",
        lambda w: the(w).shapes[1].mesh.scale == (1, 2, 3),
    ),
    ("surface", "friction"): ("", lambda w: the(w).friction == 0.5),
    ("friction", "ode"): ("", lambda w: the(w).friction == 0.5),
    ("friction", "torsional"): (
        "<torsional><coefficient>0.5</coefficient><patch_radius>0.02</patch_radius></torsional>",
        lambda w: the(w).friction.torsional == pytest.approx(3 * math.pi / 16 * 0.01),
    ),
    ("friction/ode", "mu"): ("<mu>0.3</mu>", lambda w: the(w).friction == 0.3),
    ("friction/torsional", "coefficient"): (
        "<patch_radius>0.02</patch_radius><coefficient>0.5</coefficient>",
        lambda w: the(w).friction.torsional == pytest.approx(3 * math.pi / 16 * 0.01),
    ),
    ("friction/torsional", "patch_radius"): (
        "<patch_radius>0.02</patch_radius>",
        lambda w: the(w).friction.torsional == pytest.approx(3 * math.pi / 16 * 0.02),
    ),
    ("material", "diffuse"): (
        "<diffuse>1 0 0</diffuse>",
        lambda w: the(w).visuals[0].color == (1, 0, 0, 1),
    ),
    ("material", "ambient"): None,  # below: where there is no diffuse
    ("material", "script"): None,
    ("joint", "parent"): ("<parent>world</parent>", lambda w: the(w, "m::lid").static),
    ("joint", "child"): ("<parent>world</parent><child>l</child>", lambda w: the(w, "m::l").static),
    ("joint", "pose"): None,  # below: a frame
    **dict.fromkeys(
        (kind, word)
        for kind in ("joint", "axis", "limit", "dynamics")
        for word in READ_WORDS[kind]
        if kind != "joint" or word == "axis"
    ),  # below: a door
    ("frame", "pose"): ("<pose>0 0 2 0 0 0</pose>", lambda w: xyz(w)[2] == 1.75),
    ("light", "pose"): (
        "<pose degrees='true'>0 0 0 90 0 0</pose>",
        lambda w: w.lights[0].direction == (0, 1, 0),
    ),
    ("light", "direction"): (
        "<direction>1 0 0</direction>",
        lambda w: w.lights[0].direction == (1, 0, 0),
    ),
    ("light", "diffuse"): (
        "<diffuse>1 0.5 0 1</diffuse>",
        lambda w: w.lights[0].diffuse == (1, 0.5, 0, 1),
    ),
    ("light", "cast_shadows"): (
        "<cast_shadows>true</cast_shadows>",
        lambda w: w.lights[0].casts_shadow,
    ),
    ("light", "light_on"): ("<light_on>false</light_on>", lambda w: not w.lights),
    ("physics", "max_step_size"): (
        "<max_step_size>0.002</max_step_size>",
        lambda w: w.physics.timestep == 0.002,
    ),
    ("link", "sensor"): (
        "<sensor name='other' type='camera'/>",
        lambda w: [camera.name for camera in w.cameras] == ["other", "eye"],
    ),
    ("sensor", "pose"): (
        "<pose relative_to='lid'>0 0 1 0 0 0</pose>",
        lambda w: eye(w).pose.frame == "m" and eye(w).pose.xyz == (0, 0, 2),
    ),
    ("sensor", "camera"): ("", lambda w: eye(w).image.height == 240),
    ("sensor", "update_rate"): ("<update_rate>5</update_rate>", lambda w: eye(w).update_rate == 5),
    ("camera", "pose"): ("<pose>0 3 0 0 0 0</pose>", lambda w: eye(w).pose.xyz == (0, 3, 0)),
    ("camera", "horizontal_fov"): (
        "<horizontal_fov>1.3962634</horizontal_fov>",
        lambda w: eye(w).horizontal_fov == 1.3962634,
    ),
    ("camera", "image"): ("", lambda w: eye(w).image.width == 640),
    ("camera", "clip"): ("", lambda w: eye(w).clip.far == 9),
    ("camera", "noise"): ("", lambda w: eye(w).noise.type == "gaussian"),
    ("camera", "optical_frame_id"): (
        "<optical_frame_id>o</optical_frame_id>",
        lambda w: eye(w).optical_frame_id == "o",
    ),
    ("image", "width"): ("<width>320</width>", lambda w: eye(w).image.width == 320),
    ("image", "height"): ("", lambda w: eye(w).image.height == 240),
    ("image", "format"): ("<format>L8</format>", lambda w: eye(w).image.format == "L8"),
    ("clip", "near"): ("<near>0.02</near>", lambda w: eye(w).clip.near == 0.02),
    ("clip", "far"): ("", lambda w: eye(w).clip.near == 0.1),
    ("noise", "type"): ("", lambda w: eye(w).noise.type == "gaussian"),
    ("noise", "mean"): ("<mean>0.1</mean>", lambda w: eye(w).noise.mean == 0.1),
    ("noise", "stddev"): ("<stddev>0.007</stddev>", lambda w: eye(w).noise.stddev == 0.007),
    ("physics", "gravity"): ("<gravity>0 0 -2</gravity>", lambda w: w.physics.gravity[2] == -2),
}


def test_every_word_that_is_read_has_its_row_here():
    assert set(READ) == {(kind, tag) for kind, words in OF_WORLDS.items() for tag in words}


@pytest.mark.parametrize(("kind", "tag"), [row for row in READ if READ[row]])
def test_a_word_that_is_read_counts(tmp_path, kind, tag):
    snippet, holds = READ[kind, tag]
    world = load(tmp_path, text_with(kind, snippet)).world
    assert holds(world), world


@pytest.mark.parametrize(
    ("kind", "tag"),
    [
        *((kind, "gz:extra") for kind in OF_WORLDS if kind not in (*OF_DOORS, "geometry")),
        ("sdf", "actor"),
        ("world", "wind"),
        ("model", "plugin"),
        ("link", "mass"),
        ("link", "velocity_decay"),
        ("surface", "bounce"),
        ("friction/ode", "slip1"),
        ("material", "pbr"),
        ("physics", "real_time_factor"),
        ("camera", "lens"),
    ],
)
def test_an_element_that_is_not_read_changes_nothing_and_is_reported(tmp_path, kind, tag):
    plain = load(tmp_path, text_with())
    text = text_with(kind, f"<{tag}>0.3</{tag}>")
    found = load(tmp_path, text)
    assert found.world == plain.world
    (note,) = set(found.notes) - set(plain.notes)
    assert note.message == f"<{tag}> of <{kind.rpartition('/')[2]}> is left out"
    assert f"<{tag}>" in text.splitlines()[note.line - 1]


@pytest.mark.parametrize(
    ("kind", "tag", "value", "is_reported"),
    [
        ("link", "gravity", "true", False),
        ("link", "gravity", "false", True),
        ("link", "gravity", "0", True),
        ("visual", "cast_shadows", "1", False),
        ("visual", "cast_shadows", "0", True),
        ("model", "self_collide", "false", False),
        ("model", "self_collide", "true", True),
        ("friction/ode", "fdir1", "0 0 0", False),
        ("friction/ode", "fdir1", "0 1 0", True),
        ("light", "intensity", "1.0", False),
        ("light", "intensity", "0", True),
    ],
)
def test_an_element_that_states_what_holds_anyway_is_not_reported(
    tmp_path, kind, tag, value, is_reported
):
    plain = load(tmp_path, text_with())
    found = load(tmp_path, text_with(kind, f"<{tag}>{value}</{tag}>"))
    assert (found.notes != plain.notes) is is_reported


@pytest.mark.parametrize("tag", ["heightmap", "image", "polyline", "torus"])
def test_a_shape_that_is_not_read_is_refused_in_a_collision(tmp_path, tag):
    text = text_with("geometry", f"<{tag}/>")
    with pytest.raises(SpecError, match=f"a collision cannot be a <{tag}>") as caught:
        load(tmp_path, text)
    assert f"<{tag}/>" in text.splitlines()[caught.value.problems[0].line - 1]


@pytest.mark.parametrize("tag", ["heightmap", "image", "polyline", "torus"])
def test_a_shape_that_is_not_read_is_not_drawn_in_a_visual(tmp_path, tag):
    visual = f"<visual name='d'><geometry><{tag}/></geometry></visual>"
    found = load(tmp_path, text_with("link", visual))
    assert f"a <{tag}> of a visual is not drawn" in [note.message for note in found.notes]
    assert found.world == load(tmp_path, text_with()).world


def test_equal_notes_are_one_with_their_number(tmp_path):
    found = load(tmp_path, text_with("link", "<battery/><battery/>"))
    (note,) = [note for note in found.notes if "<battery>" in note.message]
    assert str(note).endswith("is left out (2 times; here first)")


@pytest.mark.parametrize(
    ("inertial", "reported"),
    [
        ("<inertial><mass>1</mass></inertial>", "has 1 kg m^2 about each axis"),
        ("", "has 1 kg and 1 kg m^2"),
    ],
)
def test_what_sdf_takes_for_a_missing_inertia_is_reported(tmp_path, inertial, reported):
    tensor = "<inertia><ixx>0.01</ixx><iyy>0.01</iyy><izz>0.01</izz></inertia>"
    given = f"<inertial><mass>1</mass>{tensor}</inertial>"
    text = text_with()
    assert given in text
    assert not any(reported in note.message for note in load(tmp_path, text).notes)
    found = load(tmp_path, text.replace(given, inertial, 1))
    assert any(reported in note.message for note in found.notes)


AUTOMATIC = text_with("inertial", "").replace(
    "<inertial><mass>2</mass>\n     <inertia><ixx>0.02</ixx><iyy>0.02</iyy>"
    "<izz>0.02</izz></inertia></inertial>",
    "<inertial auto='true'>{inertial}</inertial>",
)


def automatic(folder, inertial="", collision=""):
    text = AUTOMATIC.replace("{inertial}", inertial)
    text = text.replace('<collision name="c">', f'<collision name="c">{collision}', 1)
    text = text.replace('<joint name="j" type="fixed">', "<frame name='x'>")
    text = text.replace("<parent>l</parent><child>lid</child></joint>", "</frame>")
    return the(load(folder, text).world, "m::l")


def test_automatic_inertia_is_that_of_the_collisions_at_their_density(tmp_path):
    volume = 0.1 * 0.2 * 0.3
    assert automatic(tmp_path).mass == pytest.approx(1000 * volume)
    assert automatic(tmp_path, "<density>200</density>").mass == pytest.approx(200 * volume)
    found = automatic(tmp_path, "<density>200</density>", "<density>300</density>")
    assert found.mass == pytest.approx(300 * volume)
    assert found.inertia.ixx == pytest.approx(300 * volume / 12 * (0.2**2 + 0.3**2))
    scaled = automatic(tmp_path, "<mass>2</mass>")
    assert scaled.mass == pytest.approx(2)
    assert scaled.inertia.izz == pytest.approx(2 / 12 * (0.1**2 + 0.2**2))


def test_the_colour_is_the_ambient_or_the_scripts_where_there_is_no_diffuse(tmp_path):
    bare = text_with().replace("<diffuse>0 1 0 1</diffuse>", "{}")
    ambient = load(tmp_path, bare.replace("{}", "<ambient>0 0 1 1</ambient>")).world
    assert the(ambient).visuals[0].color == (0, 0, 1, 1)
    script = "<script><uri>file://m</uri><name>Gazebo/{name}</name></script>"
    red = load(tmp_path, bare.replace("{}", script.replace("{name}", "Red"))).world
    assert the(red).visuals[0].color == (1, 0, 0, 1)
    wood = load(tmp_path, bare.replace("{}", script.replace("{name}", "Wood")))
    assert the(wood.world).visuals[0].color is None
    assert "the material script `Gazebo/Wood` is not a plain colour" in str(wood.notes)


def test_a_file_of_models_alone_is_a_world_of_them(tmp_path):
    text = "<sdf version='1.9'><light name='s' type='directional'/>" + A_MODEL + "</sdf>"
    world = load(tmp_path, text).world
    assert (world.world, names(world), len(world.lights)) == ("world", ["n"], 1)


def test_lights_of_other_kinds_are_reported(tmp_path):
    found = load(tmp_path, text_with("world", "<light name='o' type='spot'/>"))
    assert "a spot light is left out: pictures have directional ones" in [
        note.message for note in found.notes
    ]
    assert len(found.world.lights) == 1


def test_a_door_on_what_stands_still_is_a_joint(tmp_path):
    joint, notes = door(
        tmp_path,
        axis="<xyz>0 0 -2</xyz>",
        limit="<lower>0</lower><upper>1.5</upper>",
        dynamics="<friction>0.3</friction><damping>0.2</damping>"
        "<spring_stiffness>4</spring_stiffness><spring_reference>0.7</spring_reference>",
    )
    assert notes == []
    hinge = joint.hinge
    assert (joint.name, joint.mass, hinge.range, hinge.start) == ("hinge", 1, (0, 1.5), 0)
    assert (hinge.friction, hinge.damping) == (0.3, 0.2)
    assert (hinge.stiffness, hinge.rest) == (4, 0.7)
    assert hinge.axis == pytest.approx((0, 0, -1))
    assert hinge.at == pytest.approx((-0.2, 0.2, 0))
    panel = joint.shapes[0].pose.se3()
    assert panel.translation == pytest.approx(
        (-0.2 + 0.2 * math.sin(0.1), 0.2 - 0.2 * math.cos(0.1), 0)
    )


def test_an_axis_is_in_the_frame_that_the_file_names(tmp_path):
    own, _ = door(tmp_path, kind="prismatic", axis="<xyz>1 0 0</xyz>")
    assert own.slide.axis == pytest.approx((math.cos(0.1), math.sin(0.1), 0))
    other, _ = door(tmp_path, kind="prismatic", axis="<xyz expressed_in='__model__'>1 0 0</xyz>")
    assert other.slide.axis == pytest.approx((1, 0, 0))
    model, _ = door(
        tmp_path,
        kind="prismatic",
        axis="<xyz>1 0 0</xyz><use_parent_model_frame>1</use_parent_model_frame>",
    )
    assert model.slide.axis == pytest.approx((1, 0, 0))


def test_a_joint_without_limits_gets_some_with_a_note(tmp_path):
    endless, notes = door(tmp_path, kind="continuous")
    assert endless.hinge.range == pytest.approx((-math.pi, math.pi))
    assert notes == ["the joint 'hinge' is limited to -3.14159 to 3.14159 here"]
    slide, notes = door(tmp_path, kind="prismatic", limit="<upper>0.2</upper><effort>3</effort>")
    assert slide.slide.range == (-1, 0.2)
    assert "<effort> of <limit> is left out" in notes


@pytest.mark.parametrize(
    ("axis", "message"),
    [("<xyz>0 0 0</xyz>", "an axis must not be 0 0 0"), ("<xyz>0 1</xyz>", "3")],
)
def test_an_axis_that_is_none_is_refused(tmp_path, axis, message):
    with pytest.raises(SpecError, match=message):
        door(tmp_path, axis=axis)


def test_a_joint_on_a_part_or_between_what_may_fall_is_held(tmp_path):
    knob = """<joint name='turn' type='revolute'><parent>cabinet::door</parent><child>knob</child>
     <axis/></joint><model name='knob'><link name='l'><collision name='c'><geometry><sphere><radius>
     0.02</radius></sphere></geometry></collision>"""
    joint, notes = door(tmp_path, more=f"{knob}{INERTIAL}</link></model>")
    assert len(joint.shapes) == 2
    assert notes[-1] == "the revolute joint 'turn' is held in its initial position"
