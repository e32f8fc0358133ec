"""The page on worlds of other programs: elements that are read, ignored and refused."""

from __future__ import annotations

from harness.world.sdf.elements import WORDS
from harness.world.sdf.model_path import VARIABLES

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
become one object, and a movable joint is held in its initial position, with a note. Links without
a joint become separate objects named `model::link`. Collisions become the object's shapes, each
with its friction. Visuals of the same shapes colour them; other visuals are drawn in their place.
A link without an inertial has 1 kg and 1 kg m^2, as SDF specifies, with a note. An inertia that no
rigid body can have and a mass of 0 are refused. A camera sensor becomes a camera of the world on
that object with the sensor's name, or `model::sensor` when several sensors have the same name;
`capture` and `sees` refer to it."""

WORDS_HEAD = """## Elements of SDF

SDF 1.4 to 1.11. *Read* elements have an effect. *Ignored* elements lead to a note, unless they
state the default (`static` false, gravity on). *Refused* elements are errors. Any other element
leads to a note that it is not known."""


COMMAND = """## Conversion to world files

`harness import sdf FILE` and `harness import scene FILE` write an equivalent
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
| `cone`, octrees | refused | |"""


def formats_page() -> str:
    """The page as Markdown."""
    variables = ", ".join(f"`{name}`" for name in VARIABLES)
    parts = [
        HEAD,
        MODELS.format(variables=variables),
        BECOMES,
        WORDS_HEAD,
        sdf_table(),
        SCENES,
        COMMAND,
    ]
    return "\n\n".join(parts) + "\n"


def sdf_table() -> str:
    """The elements of SDF as a Markdown table."""
    rows = ["| in | element | here | |", "| --- | --- | --- | --- |"]
    for kind, words in WORDS.items():
        rows += [
            f"| `{kind}` | `{tag}` | {word.treatment} | {word.meaning} |"
            for tag, word in words.items()
        ]
    return "\n".join(rows)
