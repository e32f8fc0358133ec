"""Damaged copies of good input, the same for the same seed."""

from __future__ import annotations

import copy
import io
import random
import zipfile

import numpy as np

NUMBERS = (1e308, -1e308, 5e-324, 1e-300, -1.0, 0.0, 1e18, 2**53, 1e9)
"""Huge, denormal, negative and zero."""
STRANGE = (*NUMBERS, None, True, "", "x", "NaN", [], {}, [1e308] * 3, {"a": 1}, "\ud800", 10**400)
"""Values that take the place of any other in a JSON document."""
LENGTHS = (0, 1, 2**31 - 1, 2**32 - 1, 2**62, 2**64 - 1)
"""Lengths and counts of binary records."""


def damaged_bytes(data: bytes, rng: random.Random) -> bytes:
    """The bytes with some flipped, a length changed, a part cut off, repeated or removed."""
    changed = bytearray(data)
    place = rng.randrange(len(changed))
    match rng.randrange(6):
        case 0:
            return bytes(changed[:place])
        case 1:
            size = rng.choice((2, 4, 8))
            value = rng.choice(LENGTHS) % 256**size
            changed[place : place + size] = value.to_bytes(size, "little")
        case 2:
            del changed[place : place + rng.randrange(1, 64)]
        case 3:
            changed[place:place] = changed[place : place + rng.randrange(1, 64)]
        case _:
            for _ in range(rng.choice((1, 1, 2, 8, 64))):
                changed[rng.randrange(len(changed))] ^= 1 << rng.randrange(8)
    return bytes(changed)


def damaged_text(text: str, rng: random.Random) -> bytes:
    """A text with a word removed, doubled, or replaced by a number, a name or no UTF-8."""
    data = text.encode()
    words = [m for m in _words(text) if m[1] > m[0]]
    if not words or rng.random() < 0.3:
        return damaged_bytes(data, rng)
    begin, end = rng.choice(words)
    numbers = ("1e308", "-1e308", "1e999", "nan", "-1", "0", "5e-324", "1 2", "x", "", "1,5")
    with_names = rng.choice(words)
    replaced = rng.choice((*numbers, text[slice(*with_names)], text[begin:end] * 2, "\ufffe"))
    return (text[:begin] + replaced + text[end:]).encode()


def _words(text: str) -> list[tuple[int, int]]:
    """Where words, numbers and quoted texts begin and end."""
    spans: list[tuple[int, int]] = []
    begin = None
    for place, character in enumerate(f"{text} "):
        is_word = character.isalnum() or character in "_.-+"
        if is_word and begin is None:
            begin = place
        elif not is_word and begin is not None:
            spans.append((begin, place))
            begin = None
    return spans


def places_in(document: object, place: tuple = ()) -> list[tuple]:
    """The path of every value in a document of mappings and lists."""
    found = [place] if place else []
    match document:
        case dict():
            items = document.items()
        case list():
            items = enumerate(document)
        case _:
            return found
    return found + [each for key, value in items for each in places_in(value, (*place, key))]


def put(document: object, place: tuple, value: object) -> object:
    """A copy of the document with a value in a place."""
    changed = copy.deepcopy(document)
    inner = changed
    for key in place[:-1]:
        inner = inner[key]
    inner[place[-1]] = value
    return changed


def damaged_document(document: object, rng: random.Random) -> object:
    """A document with a value replaced, removed, or a list cut."""
    place = rng.choice(places_in(document))
    inner = document
    for key in place:
        inner = inner[key]
    if isinstance(inner, list) and inner and rng.random() < 0.5:
        return put(document, place, rng.choice((inner[:-1], inner * 2, inner[::-1])))
    if rng.random() < 0.2:
        changed = copy.deepcopy(document)
        holder = changed
        for key in place[:-1]:
            holder = holder[key]
        del holder[place[-1]]
        return changed
    return put(document, place, copy.deepcopy(rng.choice(STRANGE)))


def damaged_arrays(arrays: dict[str, np.ndarray], rng: random.Random) -> dict[str, np.ndarray]:
    """Arrays of which one has another length, shape, type or content, or is gone."""
    name = rng.choice(sorted(arrays))
    array = arrays[name]
    changes = (
        lambda: array[:-1],
        lambda: np.concatenate([array, array]),
        lambda: array[:0],
        lambda: array[..., None],
        lambda: array.reshape(-1),
        lambda: array.astype(np.float32),
        lambda: array.astype(complex),
        lambda: array.astype(str),
        lambda: np.full_like(array, rng.choice((0, -1))),
        lambda: array * -1,
        lambda: np.where(np.arange(array.size).reshape(array.shape) % 7, array, 1e308),
        lambda: np.full(array.shape, np.nan),
        lambda: np.full(array.shape, np.inf),
        lambda: np.array(array[0] if array.size else 0),
        lambda: None,
    )
    changed = rng.choice(changes)()
    others = {key: value for key, value in arrays.items() if key != name}
    if changed is None:
        return others
    return {**others, rng.choice((name, name, name, f"{name}x", f"x/{name}")): changed}


def npz_bytes(arrays: dict[str, np.ndarray]) -> bytes:
    """The arrays as an .npz file."""
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, array in arrays.items():
            member = io.BytesIO()
            np.lib.format.write_array(member, np.asarray(array), allow_pickle=True)
            archive.writestr(f"{name}.npy", member.getvalue())
    return stream.getvalue()
