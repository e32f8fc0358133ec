"""Links the object file of a function into this process, where that takes no more than addresses.

LLVM's own linker needs a library that takes 50 MB and a tenth of a second to load. Object files of
its large code model for x86-64 contain a single kind of relocation, the 64-bit address of a symbol.
"""

from __future__ import annotations

import ctypes
import mmap
import struct
import sys
from typing import NamedTuple

_ELF64_LITTLE_ENDIAN = b"\x7fELF\x02\x01"
_X86_64 = 62
_SECTION, _SYMBOL, _RELOCATION = map(struct.Struct, ("<4xIQ8xQQIIQ8x", "<I2xHQ8x", "<QIIq"))
_SYMBOL_TABLE, _RELOCATIONS, _NO_BITS = 2, 4, 8
_ALLOCATED = 2
_ADDRESS_64 = 1
_RESERVED = 0xFF00
"""Numbers of sections from here on have a special meaning."""


class CannotLinkError(Exception):
    """The object file needs a real linker."""


class _Section(NamedTuple):
    kind: int
    flags: int
    offset: int
    size: int
    link: int
    info: int
    alignment: int


class LinkedObject:
    """The code of an object file in executable memory, for as long as this object exists."""

    def __init__(self, content: bytes) -> None:
        """Copy the sections and fill in the addresses.

        Raises:
            CannotLinkError: The file is for another system, or has relocations of other kinds.
            OSError: The system allows no memory that is both written and executed.
        """
        machine = struct.unpack_from("<H", content, 18)[0]
        if sys.platform != "linux" or machine != _X86_64 or content[:6] != _ELF64_LITTLE_ENDIAN:
            raise CannotLinkError
        begin, count = struct.unpack_from("<Q", content, 40)[0], content[60] + 256 * content[61]
        table = content[begin : begin + count * _SECTION.size]
        self._content = content
        self._sections = [_Section(*entry) for entry in _SECTION.iter_unpack(table)]
        self._starts, size = dict[int, int](), 0
        for number, section in enumerate(self._sections):
            if section.flags & _ALLOCATED:
                self._starts[number] = size + -size % max(section.alignment, 1)
                size = self._starts[number] + section.size
        access = mmap.PROT_READ | mmap.PROT_WRITE | mmap.PROT_EXEC
        self._memory = mmap.mmap(-1, max(size, 1), flags=mmap.MAP_PRIVATE, prot=access)
        self._base = ctypes.addressof(ctypes.c_char.from_buffer(self._memory))
        for number, start in self._starts.items():
            section = self._sections[number]
            if section.kind != _NO_BITS:
                self._memory[start : start + section.size] = self._bytes(section)
        [symbols] = (each for each in self._sections if each.kind == _SYMBOL_TABLE)
        self._names = self._bytes(self._sections[symbols.link])
        self._symbols = [*_SYMBOL.iter_unpack(self._bytes(symbols))]
        for section in self._sections:
            if section.kind == _RELOCATIONS:
                self._relocate(section)

    def address(self, name: str) -> int:
        """The address of a function of the file."""
        return next(self._address(symbol) for symbol in self._symbols if self._name(symbol) == name)

    def _relocate(self, section: _Section) -> None:
        start = self._starts[section.info]
        for offset, kind, number, addend in _RELOCATION.iter_unpack(self._bytes(section)):
            if kind != _ADDRESS_64:
                raise CannotLinkError
            address = self._address(self._symbols[number]) + addend
            struct.pack_into("<Q", self._memory, start + offset, address)

    def _address(self, symbol: tuple[int, ...]) -> int:
        """Where a symbol is: in a section of the file, or in a library of this process."""
        _, section, value = symbol
        if section >= _RESERVED:
            raise CannotLinkError
        if section:
            return self._base + self._starts[section] + value
        try:
            function = getattr(ctypes.CDLL(None), self._name(symbol))
        except AttributeError as error:
            raise CannotLinkError from error
        return ctypes.cast(function, ctypes.c_void_p).value or 0

    def _name(self, symbol: tuple[int, ...]) -> str:
        begin = symbol[0]
        return self._names[begin : self._names.index(b"\0", begin)].decode()

    def _bytes(self, section: _Section) -> bytes:
        return self._content[section.offset : section.offset + section.size]
