"""The page on worlds of other programs: what of their files is read, ignored, refused."""

from __future__ import annotations

from harness.importers.model_path import VARIABLES
from harness.importers.sdf_words import WORDS

HEAD = """# Worlds of other programs

A scenario names an SDF file as it does a world of its own:

```yaml
world: cell.sdf
```

or, with folders to look models up in,

```yaml
world: {name: cell.sdf, model_path: [models, ../shared]}
```

Nothing is converted on the way: the file is read each time, and what of it has no meaning here
is told by `harness check` and stands among the findings of every run."""

MODELS = """## Where models and meshes are found

`model://name/...` and `package://name/...` are looked up in the folders of `model_path`, the
world file's folder, `models` beside it, and the folders of {variables}, in this order; a path
is relative to the file that has it. Nothing outside of these folders is read, and nothing is
downloaded: an address of Fuel is looked up in Gazebo's cache (`~/.gz/fuel`). `model://sun` and
`model://ground_plane` are there without Gazebo."""

BECOMES = """## What a model becomes

A model is one object, called as the model. Its links are rigid: what joints hold together is
one object, and a joint that could move is held where it stands, with a note. Links that no
joint holds are objects of their own, called `model::link`. Collisions are its shapes, each with
its friction; visuals that are the same shapes colour them, others are drawn in their place. A
link without an inertial has 1 kg and 1 kg m^2, as SDF has it, with a note. An inertia that no
body can have, and a mass of 0, are refused. A camera sensor is a camera of the world on that
object, called as the sensor, or `model::sensor` where several are called alike; `capture` and
`sees` name it."""

WORDS_HEAD = """## Words of SDF

SDF 1.4 to 1.11. *Read* words count; *ignored* ones are told of, unless they say what is so
anyway (`static` false, gravity on); *refused* ones are errors. Any other element is told of as
not known."""


COMMAND = """## As files of ours

`harness import sdf FILE` and `harness import scene FILE` write what they read as a
[world file](../scenarios/SCENARIO.md#world-file) with the same meaning, to be changed by hand:
`-o` says where, `--model-path` where models are looked up, and nothing is overwritten without
`--force`. What is not taken over stands at the top as a comment."""

SCENES = """## MoveIt scenes

`.scene` files have no masses and nothing that moves, so they are imported and not run as they
are. Both forms are read: since MoveIt 1.1 objects have poses, before only their shapes had.

| in | here | |
| --- | --- | --- |
| name of the scene | read | the world's title |
| `*` and a name | read | a static object, known to planner and physics |
| pose: position, quaternion xyzw | read | in MoveIt's planning frame, taken as the world |
| `box`, `sphere`, `cylinder` | read | full size; radius; radius and length |
| `mesh` | read | its triangles, written as an STL file beside the world |
| `plane` | read | solid behind its normal, where MoveIt's is thin; told |
| colour | read | four zeros say none |
| subframes | ignored | told |
| object without shapes | ignored | told |
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
    """The words of SDF as a Markdown table."""
    rows = ["| in | element | here | |", "| --- | --- | --- | --- |"]
    for kind, words in WORDS.items():
        rows += [
            f"| `{kind}` | `{tag}` | {word.treatment} | {word.meaning} |"
            for tag, word in words.items()
        ]
    return "\n".join(rows)
