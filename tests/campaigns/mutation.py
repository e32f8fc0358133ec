"""Changed copies of good files: as text and bytes, and as the documents that they are."""

from __future__ import annotations

import copy
import json
import xml.etree.ElementTree as ET  # of files of the repository
from collections.abc import Callable, Sequence
from functools import cache
from random import Random

import yaml

from tests.damaged.mutants import STRANGE, damaged_bytes, damaged_document, damaged_text, places_in

TOKENS = (
    *("1e308", "-1e308", "5e-324", "nan", ".inf", "0", "-1", "1e9", "true", "null", "''", "~"),
    *("[]", "{}", "5 cm", "90 deg", "5 m**m", "${x}", "${'a'*9}", "*a", "&a x", "!!str x"),
    *("pi/0", "world"),
    *("\0", "\u2028", "../..", "/etc/passwd", "a" * 300, "package://x/y", "file:///dev/zero"),
)  # fmt: skip
Mutate = Callable[[Sequence[bytes], Random], bytes]


def _text(data: bytes) -> str:
    return data.decode("utf-8", errors="replace")


def _encoded(text: str) -> bytes:
    return text.encode("utf-8", errors="surrogatepass")


def of_bytes(corpus: Sequence[bytes], rng: Random) -> bytes:
    """Bytes flipped, cut, repeated or exchanged with those of another file."""
    data = rng.choice(corpus)
    if rng.random() < 0.1:
        other = rng.choice(corpus)
        return data[: rng.randrange(len(data) + 1)] + other[rng.randrange(len(other) + 1) :]
    for _ in range(rng.choice((1, 1, 2, 4))):
        data = damaged_bytes(data, rng) if data else b"\0"
    return data


def of_text(corpus: Sequence[bytes], rng: Random) -> bytes:
    """Words exchanged with others, with tokens, or with words of another file."""
    text = _text(rng.choice(corpus))
    for _ in range(rng.choice((1, 1, 2, 4))):
        if rng.random() < 0.3:
            place = rng.randrange(len(text) + 1)
            text = text[:place] + rng.choice(TOKENS) + text[place:]
        elif text.strip():
            text = _text(damaged_text(text, rng))
    return _encoded(text)


def _parts(document: object) -> list[tuple]:
    return places_in(document)


def _at(document: object, place: tuple) -> object:
    for key in place:
        document = document[key]
    return document


def _changed(document: object, others: Sequence[object], rng: Random) -> object:
    """A document with values and keys of this or another one in new places."""
    for _ in range(rng.choice((1, 1, 2, 3))):
        places = _parts(document)
        if not places:
            return document
        place = rng.choice(places)
        holder, key = _at(document, place[:-1]), place[-1]
        match rng.randrange(5):
            case 0:
                document = damaged_document(document, rng)
            case 1:
                holder[key] = copy.deepcopy(rng.choice((*TOKENS, *STRANGE)))
            case 2:
                other = rng.choice(others)
                found = _parts(other)
                holder[key] = json.loads(json.dumps(_at(other, rng.choice(found)), default=str))
            case 3 if isinstance(holder, dict):
                known = [each[-1] for each in places if isinstance(each[-1], str)]
                holder[rng.choice((*known, *TOKENS))] = holder.pop(key)
            case _ if isinstance(holder, list):
                holder[:] = holder * rng.choice((2, 30)) if rng.random() < 0.5 else holder[:key]
            case _:
                holder[key] = [holder[key]] * rng.randrange(3)
    return document


def _document(data: bytes) -> object:
    return copy.deepcopy(_parsed(data))


@cache
def _parsed(data: bytes) -> object:
    return yaml.load(data, Loader=yaml.CSafeLoader)


def of_yaml(corpus: Sequence[bytes], rng: Random) -> bytes:
    """A YAML document with exchanged values and keys; or its text."""
    if rng.random() < 0.3:
        return of_text(corpus, rng)
    documents = [_document(rng.choice(corpus)) for _ in range(2)]
    changed = _changed(documents[0], documents, rng)
    try:
        return _encoded(
            yaml.dump(changed, Dumper=yaml.CSafeDumper, sort_keys=False, allow_unicode=True)
        )
    except UnicodeEncodeError:  # half a character
        return _encoded(json.dumps(changed))


def of_json(corpus: Sequence[bytes], rng: Random) -> bytes:
    """A JSON document with exchanged values and keys; or its text."""
    if rng.random() < 0.2:
        return of_text(corpus, rng)
    documents = [json.loads(rng.choice(corpus)) for _ in range(2)]
    return _encoded(json.dumps(_changed(documents[0], documents, rng)))


def of_lines(corpus: Sequence[bytes], rng: Random) -> bytes:
    """A line of JSON in a file of lines, changed; or the whole as text."""
    if rng.random() < 0.3:
        return of_text(corpus, rng)
    lines = rng.choice(corpus).splitlines(keepends=True)
    number = rng.randrange(len(lines))
    lines[number] = of_json([lines[number]], rng) + b"\n"
    if rng.random() < 0.2:
        rng.shuffle(lines)
    return b"".join(lines)


def of_xml(corpus: Sequence[bytes], rng: Random) -> bytes:
    """An XML document with exchanged elements, attributes and texts; or its text."""
    if rng.random() < 0.3:
        return of_text(corpus, rng)
    root = ET.fromstring(_text(rng.choice(corpus)))
    for _ in range(rng.choice((1, 1, 2, 3))):
        elements = list(root.iter())
        element, other = rng.choice(elements), rng.choice(elements)
        match rng.randrange(6):
            case 0 if element.attrib:
                name = rng.choice(list(element.attrib))
                element.set(name, rng.choice((*TOKENS[:24], *other.attrib.values())))
            case 1 if element.attrib:
                del element.attrib[rng.choice(list(element.attrib))]
            case 2 if len(element):
                element.remove(rng.choice(list(element)))
            case 3:
                copied = ET.fromstring(ET.tostring(other))
                element.insert(rng.randrange(len(element) + 1), copied)
            case 4:
                element.tag = other.tag
            case _:
                element.text = rng.choice((*TOKENS[:24], other.text or ""))
    return _encoded(ET.tostring(root, encoding="unicode"))
