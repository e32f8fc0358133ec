"""include: the steps of another file."""

from __future__ import annotations

from typing import Any, ClassVar

from pydantic import Field

from harness.cell.cell import Cell
from harness.cell.step import Step
from harness.language.base import Name


class Include(Step):
    """Run the steps of another file; an `id` and a dot are put in front of the ids of its steps.

    The file has `steps`, and `params` with their defaults; it can use no other parameters.
    """

    short = "file"

    verb: ClassVar[str] = "include"
    plans: ClassVar[bool] = False

    file: str = Field(description="The path of the file, from this file.")
    params: dict[Name, Any] = Field(
        default_factory=dict, description="Values of the parameters `${name}` of that file."
    )

    def summary(self) -> str:
        return self.file

    def execute(self, cell: Cell) -> None:
        """Never called: reading a file puts the included steps in this step's place.

        Raises:
            RuntimeError: Always.
        """
        del cell
        raise RuntimeError(f"the steps of '{self.file}' were not read")
