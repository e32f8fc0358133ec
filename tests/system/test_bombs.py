"""Small files that say that they are huge are refused, in bounded memory, at their place."""

import io
import json
import os
import re
import struct
import zipfile
import zlib
from pathlib import Path

import numpy as np
import pytest
import trimesh
import zstandard
from mcap.writer import CompressionType
from mcap.writer import Writer as McapWriter

from harness.core.limits import READING_MEMORY
from tests.commands import forked
from tests.damaged.trials import tiny_run

WITH_MESH = """\
scenario: an object of a mesh
robot: open_manipulator_x
objects: [{{name: thing, mesh: {{file: {name}}}, static: true, pose: {{xyz: [0.3, 0.3, 0.1]}}}}]
steps: [{{wait: 10 ms}}]
"""


def scenario(folder, text):
    file = folder / "bomb.scenario.yaml"
    file.write_text(text)
    return "check", file


def mesh(name, content):
    def write(folder):
        (folder / name).write_bytes(content())
        return scenario(folder, WITH_MESH.format(name=name))

    return write


def glb(document, binary=b""):
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<I4s", len(text), b"JSON") + text
    if binary:
        chunks += struct.pack("<I4s", len(binary), b"BIN\0") + binary
    return struct.pack("<4sII", b"glTF", 2, 12 + len(chunks)) + chunks


def gltf_of_many_corners():
    """Accessors without data are zeros, as many as they say."""
    accessors = [
        {"componentType": 5126, "count": 10**9, "type": "VEC3"},
        {"componentType": 5125, "count": 3 * 10**8, "type": "SCALAR"},
    ]
    part = {"attributes": {"POSITION": 0}, "indices": 1}
    return glb(
        {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": [{"mesh": 0}],
            "meshes": [{"primitives": [part]}],
            "accessors": accessors,
        }
    )


def gltf_of_many_nodes():
    """Each node shows the next one ten times."""
    levels = 8
    nodes = [{"children": [n + 1] * 10} for n in range(levels)] + [{"mesh": 0}]
    return glb(
        {
            "asset": {"version": "2.0"},
            "scene": 0,
            "scenes": [{"nodes": [0]}],
            "nodes": nodes,
            "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
            "accessors": [{"componentType": 5126, "count": 3, "type": "VEC3"}],
        }
    )


PLY = b"ply\nformat binary_little_endian 1.0\nelement vertex 2000000000\nproperty float x\n"
PLY += b"property float y\nproperty float z\nelement face 1\n"
PLY += b"property list uchar int vertex_indices\nend_header\n"


def collada_of_repeated_nodes():
    """65,536 times a ball of 20,480 triangles."""
    ball = trimesh.creation.icosphere(5).export(file_type="dae").decode()
    begin = ball.index("<instance_geometry")
    end = ball.index("</instance_geometry>") + len("</instance_geometry>")
    shown, twice = ball[begin:end], '<instance_node url="#n{0}"/>' * 2
    nodes = "".join(f'<node id="n{n}">{twice.format(n + 1)}</node>' for n in range(16))
    nodes = f'<library_nodes>{nodes}<node id="n16">{shown}</node></library_nodes>'
    repeated = ball[:begin] + '<instance_node url="#n0"/>' + ball[end:]
    return repeated.replace("<library_visual_scenes", f"{nodes}<library_visual_scenes").encode()


def aliases(folder):
    lines = ["a0: &a0 [x, x, x, x, x, x, x, x, x]"]
    lines += [f"a{n}: &a{n} [{', '.join([f'*a{n - 1}'] * 9)}]" for n in range(1, 12)]
    return scenario(folder, "\n".join(lines))


def entities(folder):
    lines = ['<!DOCTYPE a [<!ENTITY e0 "x">']
    lines += [f'<!ENTITY e{n} "{f"&e{n - 1};" * 10}">' for n in range(1, 12)]
    (folder / "world.sdf").write_text("".join(lines) + "]><sdf version='1.9'>&e11;</sdf>")
    return scenario(
        folder,
        "scenario: x\nrobot: open_manipulator_x\nworld: {name: ./world.sdf}\n"
        "steps: [{wait: 1 s}]\n",
    )


def of_xacro(body):
    def write(folder):
        (folder / "arm.xacro").write_text(
            f'<robot name="a" xmlns:xacro="http://ros.org/wiki/xacro">{body}'
            '<link name="b"/></robot>'
        )
        return scenario(folder, "scenario: x\nrobot: {urdf: arm.xacro}\nsteps: [{wait: 1 s}]\n")

    return write


def recording(folder, name, content):
    (folder / name).write_bytes(content)
    _, file = scenario(
        folder,
        "scenario: x\nrobot: open_manipulator_x\nsteps: [{wait: 1 s}]\n"
        "expect: [always: within_limits]\n",
    )
    return "grade", file, folder / name


def mcap_chunk(compression, data, stated):
    """A chunk that states its unpacked size."""

    def write(folder):
        packed = data()
        stream = io.BytesIO()
        writer = McapWriter(stream, compression=CompressionType.NONE, use_chunking=False)
        writer.start(profile="ros2")
        chunk = struct.pack("<QQQI", 0, 0, stated, 0)
        chunk += struct.pack("<I", len(compression)) + compression.encode()
        chunk += struct.pack("<Q", len(packed)) + packed
        record = b"\x06" + struct.pack("<Q", len(chunk)) + chunk
        return recording(folder, "bag.mcap", stream.getvalue() + record)

    return write


def zstd_zeros(size):
    packer = zstandard.ZstdCompressor().compressobj()
    return b"".join([packer.compress(bytes(2**20)) for _ in range(size // 2**20)]) + packer.flush()


def wide_csv(folder):
    return recording(folder, "joints.csv", b"time,joint1\n" + b"0," * 30_000_000 + b"0\n")


def long_field(folder):
    return recording(folder, "joints.csv", b"time,joint1\n0," + b"1" * 200_000 + b"\n")


def of_run(name, content):
    def write(folder):
        tiny_run(folder)
        (folder / "run" / name).write_bytes(content())
        return "judge", folder / "run"

    return write


def npz_of(shape):
    stream = io.BytesIO()
    with (
        zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED, compresslevel=1) as archive,
        archive.open("times.npy", "w", force_zip64=True) as member,
    ):
        header = {"descr": "<f8", "fortran_order": False, "shape": shape}
        np.lib.format.write_array_header_1_0(member, header)
        for _ in range(64):
            member.write(bytes(2**20))
    return stream.getvalue()


def png(width, height):
    """A picture that states its size, and has none of its rows."""

    def chunk(kind, data):
        return (
            struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))
        )

    head = struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0)
    rows = zlib.compress(bytes(10_000))
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", head) + chunk(b"IDAT", rows) + chunk(b"IEND", b"")


def picture_of_run(folder):
    """A captured picture that unpacks to gigabytes, in a folder of a run that is exported."""
    from tests.running import run_case

    file = folder / "camera.scenario.yaml"
    file.write_text(
        "scenario: a picture\nrobot: open_manipulator_x\ncameras:\n"
        "  - {name: eye, pose: {xyz: [0.5, 0, 0.5]}, look_at: [0, 0, 0.1],"
        " image: {width: 32, height: 24}}\n"
        "steps: [{capture: eye}]\n"
    )
    result = run_case(file, report_dir=folder / "run", stills=False, page=False)
    assert result.outcome == "passed", result.message
    [picture] = (folder / "run" / "cameras").rglob("*.color.png")
    picture.write_bytes(png(30_000, 30_000))
    return "export", folder / "run", "--bag", folder / "bag"


BOMBS = {
    "YAML aliases": (aliases, "more than 100000 values"),
    "XML entities": (entities, "DOCTYPE"),
    "xacro text": (of_xacro("<a x=\"${'a' * 10**9}\"/>"), "arm.xacro"),
    "xacro power": (of_xacro('<a x="${9 ** 9 ** 9}"/>'), "arm.xacro"),
    "xacro macros": (
        of_xacro(
            "".join(
                f'<xacro:macro name="m{n}"><xacro:m{n + 1}/><xacro:m{n + 1}/></xacro:macro>'
                for n in range(40)
            )
            + '<xacro:macro name="m40"><a/></xacro:macro><xacro:m0/>'
        ),
        "arm.xacro",
    ),
    "STL that states 4 billion facets": (
        mesh("t.stl", lambda: bytes(80) + struct.pack("<I", 2**32 - 1) + bytes(500)),
        "t.stl",
    ),
    "PLY that states 2 billion corners": (mesh("t.ply", lambda: PLY + bytes(100)), "t.ply"),
    "OBJ with a corner of no vertex": (
        mesh("t.obj", lambda: b"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 2000000000\n"),
        "t.obj",
    ),
    "GLB that states a billion corners": (mesh("t.glb", gltf_of_many_corners), "t.glb"),
    "COLLADA of repeated nodes": (mesh("t.dae", collada_of_repeated_nodes), "t.dae"),
    "GLB of repeated nodes": (mesh("t.glb", gltf_of_many_nodes), "t.glb"),
    "MCAP chunk that states exabytes": (mcap_chunk("zstd", lambda: b"abc", 2**60), "at most"),
    "MCAP chunk of zstd": (mcap_chunk("zstd", lambda: zstd_zeros(2**30), 1000), "bag.mcap"),
    "CSV of a wide row": (wide_csv, "joints.csv"),
    "CSV of a long field": (long_field, "joints.csv"),
    "run.json of a million levels": (of_run("run.json", lambda: b"[" * 10**6), "nested too deeply"),
    "run.json of 20 million lists": (
        of_run("run.json", lambda: b"[" + b"[]," * 20_000_000 + b"0]"),
        "takes more than 1 GB",
    ),
    "arrays that state exabytes": (of_run("signals.npz", lambda: npz_of((2**50,))), "signals.npz"),
    "picture of 900 million pixels": (picture_of_run, "more than 50,000,000 pixels"),
}  # fmt: skip


def judged(words, out, _notify):
    """A command, and the memory that it took, in a process of its own."""
    import contextlib

    from harness.cli.main import main

    with out.open("w") as printed:
        Path("/proc/self/clear_refs").write_text("5")  # the largest memory counts from here on
        before = _memory("VmRSS")
        with contextlib.redirect_stdout(printed), contextlib.redirect_stderr(printed):
            code = main([str(word) for word in words])
        printed.write(f"\nadded {_memory('VmHWM') - before}\n")
    os._exit(code)


def _memory(name):
    status = Path("/proc/self/status").read_text()
    return 1024 * int(re.search(rf"{name}:\s+(\d+) kB", status)[1])


@pytest.mark.nightly(but=["YAML aliases"])
@pytest.mark.parametrize("name", BOMBS)
def test_a_bomb_is_refused_in_bounded_memory(name, tmp_path):
    write, said = BOMBS[name]
    end = forked(judged, write(tmp_path), tmp_path / "printed")
    printed = (tmp_path / "printed").read_text()
    assert end.code == 2, printed
    assert "Traceback" not in printed, printed
    assert said in printed
    assert int(printed.rpartition("added ")[2]) < 1.2 * READING_MEMORY  # and the file
