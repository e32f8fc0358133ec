"""Linking an object file without LLVM: the code does what it does when LLVM links it."""

import ctypes
import math
import platform
import sys

import pytest
from llvmlite import binding as llvm

from harness.planning.collision.object_file import CannotLinkError, LinkedObject

pytestmark = pytest.mark.skipif(
    (sys.platform, platform.machine()) != ("linux", "x86_64"), reason="other systems use LLVM"
)
SOURCE = """
declare double @cos(double) nounwind
define double @half(double %x) noinline nounwind { %y = fmul double %x, 0.5  ret double %y }
define double @curve(double %x) nounwind {
  %y = call double @half(double %x)
  %c = call double @cos(double %y)
  %z = fadd double %c, 0.125
  ret double %z
}
"""


def object_file(source=SOURCE, codemodel="large"):
    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    machine = llvm.Target.from_default_triple().create_target_machine(
        codemodel=codemodel, reloc="static"
    )
    return machine.emit_object(llvm.parse_assembly(source.replace("  ret", "\n  ret")))


def test_linked_code_calls_its_own_functions_and_those_of_libraries():
    linked = LinkedObject(object_file())
    curve = ctypes.CFUNCTYPE(ctypes.c_double, ctypes.c_double)(linked.address("curve"))
    for value in (0.0, 0.3, -7.0):
        assert curve(value) == math.cos(value * 0.5) + 0.125


@pytest.mark.parametrize(
    "content",
    [
        pytest.param(lambda: object_file(codemodel="small"), id="other relocations"),
        pytest.param(lambda: object_file(SOURCE.replace("cos", "no_library_has_it")), id="unknown"),
        pytest.param(lambda: object_file().replace(b"\x3e\x00", b"\xb7\x00", 1), id="processor"),
        pytest.param(lambda: b"\xcf\xfa\xed\xfe" + bytes(100), id="format"),
    ],
)
def test_what_needs_more_is_left_to_a_linker(content):
    with pytest.raises(CannotLinkError):
        LinkedObject(content())
