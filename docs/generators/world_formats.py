"""The page on worlds of other programs: elements that are read, and how."""

from __future__ import annotations

from harness.plugins.formats.mjcf.elements import LEFT_OUT
from harness.plugins.formats.mjcf.shapes import SHAPES
from harness.plugins.formats.sdf.elements import READ
from harness.plugins.formats.sdf.model_path import VARIABLES

HEAD = """# World file formats

A scenario names an SDF file like a world file:

```yaml
world: cell.sdf
```

or, with folders to look models up in,

```yaml
world: {name: cell.sdf, model_path: [models, ../shared]}
```

The file is not converted but read each time. `harness check` and the findings of every run list
the parts of it that have no effect."""

MODELS = """## Where models and meshes are found

`model://name/...` and `package://name/...` are looked up in the folders of `model_path`, the
world file's folder, its subfolder `models`, and the folders of {variables}, in this order; a path
is relative to the file that contains it. No file outside these folders is read, and nothing is
downloaded: an address of Fuel is looked up in Gazebo's cache (`~/.gz/fuel`). `model://sun` and
`model://ground_plane` work without Gazebo."""

BECOMES = """## Models

A model becomes one object with the model's name. An object is rigid: links that joints connect
become one object. What turns or slides on something static is one of its `joints`; any other
movable joint is held in its initial position, with a note. Links without
a joint become separate objects named `model::link`. Collisions become the object's shapes, each
with its friction. Visuals of the same shapes colour them; other visuals are drawn in their place.
A link without an inertial has 1 kg and 1 kg m^2, as SDF specifies, with a note. An inertia that no
rigid body can have and a mass of 0 are refused. A camera sensor becomes a camera of the world on
that object with the sensor's name, or `model::sensor` when several sensors have the same name;
`capture` and `sees` refer to it."""

AGREEMENT = """## Agreement with SDFormat

As in SDFormat, every pose, frame and joint of a file is checked, whether something refers to it or
not: unknown frames, frames in a cycle, a joint whose parent and child are one link, the world as a
joint's child, a model without a link that is not static, an unknown `canonical_link`, two elements
of one name, a name with `::` since SDF 1.8, and two worlds of one name are errors. These files are
valid for SDFormat and are treated differently:

| file | treatment | reason |
| --- | --- | --- |
| a second world of another name | left out, with a note | a scenario has one world |
| an included actor; a light that a model includes | left out, with a note | see the elements |
| a step outside 0.1 to 20 ms | taken as 1 ms, with a note | contacts need short steps |
| frames on each other more than 50 deep | refused | it bounds the time that a file takes |
| SDF 1.3 and older | refused | `gz sdf -p` converts it |"""

WORDS_HEAD = """## Elements of SDF

SDF 1.4 to 1.11. The elements of this table have an effect. Every other element leads to a note
with its name, unless it states what holds anyway (`self_collide` false, `gravity` true). In a
collision another shape than these is an error; in a visual it is not drawn, with a note.

- Gravity is in m/s^2, a mass in kg, an inertia in kg m^2 about the axes of its `pose`, a density
  (with `auto`) in kg/m^3, `horizontal_fov` in rad up to 2.9, `update_rate` in Hz up to 120.
- An ellipsoid is 1,280 triangles, up to 0.5 % inside it; a cone is a pyramid of 32 sides. A plane
  is solid below its surface. A mesh is its convex parts.
- A contact takes the smaller `mu` of its two shapes. Torsional friction is `coefficient` times
  3 pi/16 of `patch_radius` [m]; with 0 it is that of a small soft patch.
- A colour is `diffuse`, else `ambient`, else that of a plain colour's `script` of Gazebo.
- Of several `physics` elements the default one is read, else the first; of `state` the poses of
  models in the first. Pictures are 8 to 2048 pixels wide and high, of format `R8G8B8` or `L8`.
- A movable joint of what may fall is held in its initial position; a world's fixed joint joins
  models to one object."""


MJCF = """## MuJoCo scenes

`world: scene.xml` reads an MJCF scene as MuJoCo compiles it, with its includes, defaults and
angles. Files outside the scene's folder are read in the folders of `model_path` alone.

| in | here | |
| --- | --- | --- |
| body without joints | read | a static object of the body's name |
| body with a free joint | read | an object with mass and inertia, and all that is fixed to it |
| geom of the world body | read | a static object, named after the geom or its type |
| {shapes} | read | meshes of STL or OBJ files touch as their convex hulls |
| other geoms | refused | only seen ones are ignored, with a note |
| geom with `contype` and `conaffinity` 0 | read | seen only; groups from 3 on are not drawn |
| friction | read | contacts take the smaller of two, MuJoCo's the larger; with a note |
| colours, also of materials | read | textures are ignored |
| gravity, time step | read | a step outside 0.1 to 20 ms is taken as 1 ms, with a note |
| directional lights | read | other lights are ignored, with a note |
| bodies with other joints | ignored | with what they carry, with a note |
| bodies with actuators and their base | ignored | a robot: `robot: {{mjcf: ...}}` reads it |
| mocap bodies | read | static, with a note |
{rows}
| `composite`, `flexcomp`, `extension`, `model` | refused | |"""


URDF = """## Objects in URDF

`world: cabinet.urdf` reads one object whose root stands at the world's origin; the robot's `base`
is placed relative to it.

| in | here | |
| --- | --- | --- |
| links that no joint moves | read | one static object with the name of the robot |
| joints of these that turn or slide | read | its `joints`, with limits, friction and damping |
| joints further out | ignored | held at zero, with a note |
| `mimic` | ignored | each joint moves alone, with a note |
| inertial | read | without one, the mass follows from the volume |
| names of collisions or links | read | names of shapes: `open` takes the one called `handle` |"""


COMMAND = """## Conversion to world files

`harness import sdf FILE`, `import mjcf FILE` and `import scene FILE` write an equivalent
[world file](scenario.md#world-file) that can be edited: `-o` names the output file,
`--model-path` adds folders to search for models, and no file is overwritten without `--force`. A
comment at the top lists the parts that are left out."""

SCENES = """## MoveIt scenes

`.scene` files have no masses and no moving objects, so they are imported and not run directly.
Both formats are read: objects have poses since MoveIt 1.1; before, only their shapes had poses.

| in | here | |
| --- | --- | --- |
| name of the scene | read | the world's title |
| `*` and a name | read | a static object for planner and physics |
| pose: position, quaternion xyzw | read | in MoveIt's planning frame, taken as the world |
| `box`, `sphere`, `cylinder` | read | full size; radius; radius and length |
| `mesh` | read | its triangles, written as an STL file next to the world file |
| `plane` | read | solid below its surface, while MoveIt's is thin; with a note |
| colour | read | four zeros are no colour |
| subframes | ignored | with a note |
| object without shapes | ignored | with a note |
| `cone` | read | as a pyramid of 32 sides |
| octrees | refused | |"""

MESSAGES = """## MoveIt messages in YAML

`harness import moveit FILES --robot ROBOT` reads PlanningScene and MotionPlanRequest messages, as
robowflex and MotionBenchMaker store them: vectors as lists or with their names,
`enabled` rows or plain ones, types by name or number. A scene becomes a world file, a request a
scenario; a request belongs to the scene whose name ends in the same number, or to the only scene.
Hundreds of files may be given at once; with a mistake in any of them nothing is written.

| in | here | |
| --- | --- | --- |
| `box`, `sphere`, `cylinder` of objects | read | static, in the world or the robot's root |
| `meshes` | read | of a `resource`, or of vertices and triangles, written as STL |
| `allowed_collision_matrix` | read | pairs beyond the SRDF's may touch during the motion |
| `robot_state`, `start_state` | read | the start state; the scene's where the request has none |
| `goal_constraints` of joints | read | `joints`; several sets of constraints are `any_of` |
| of a position, with an orientation | read | `position` or `pose` of the link, and tolerances |
| `group_name`, scaling factors | read | the step's `group`, `planning` |
| planner, time, attempts, colours, octomaps, padding | ignored | with a note |
| `planes` | read | solid below their surface, with a note |
| poses of shapes | read | a shape without a pose is at the origin of its object |
| attached objects, other frames | refused | |
| path and trajectory constraints | refused | the motion would be another one |"""


def formats_page() -> str:
    """The page as Markdown."""
    variables = ", ".join(f"`{name}`" for name in VARIABLES)
    rows = "\n".join(f"| `{tag}` | ignored | {why} |" for tag, why in LEFT_OUT.items())
    parts = [
        HEAD,
        MODELS.format(variables=variables),
        BECOMES,
        AGREEMENT,
        WORDS_HEAD,
        sdf_table(),
        MJCF.format(shapes=", ".join(SHAPES), rows=rows),
        SCENES,
        MESSAGES,
        URDF,
        COMMAND,
    ]
    return "\n\n".join(parts) + "\n"


def sdf_table() -> str:
    """The elements of SDF that are read as a Markdown table."""
    rows = ["| in | read |", "| --- | --- |"]
    for kind, words in (each for each in READ.items() if not each[0].startswith("robot")):
        rows.append(f"| `{kind}` | {', '.join(f'`{tag}`' for tag in words)} |")
    return "\n".join(rows)
