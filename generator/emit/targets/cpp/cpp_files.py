"""Paths and rendering of the header and the source file of a generated C++ class."""

from __future__ import annotations

from dataclasses import dataclass

from roverlink.generator.emit.render import Files, header, render

FOLDER = "generated/cpp"


@dataclass(frozen=True, slots=True)
class CppFile:
    """Header file of a generated class, and the source file with the same name if the class has one."""

    package: str
    name: str
    """Path of both files in their folders, without a suffix: ``handlers/imu_info``."""
    origin: str
    """Inputs from which the files are generated, for the comment at the top."""

    @property
    def top(self) -> str:
        """Comment lines at the top of the files."""
        return header(self.origin, "//")

    @property
    def include(self) -> str:
        """Path of the header as an include directive writes it."""
        return f"{self.package}/{self.name}.hpp"

    @property
    def guard(self) -> str:
        """Macro that guards the header against a second inclusion: ``COMMS__HANDLERS__IMU_INFO_HPP_``."""
        return self.include.replace("/", "__").replace(".", "_").upper() + "_"

    def header(self, template: str, **view: object) -> Files:
        """Yield the header file; the template sees the variables in ``view``."""
        yield f"{FOLDER}/include/{self.include}", render(f"cpp/{template}.hpp.j2", file=self, **view)

    def source(self, template: str, **view: object) -> Files:
        """Yield the source file; the template sees the variables in ``view``."""
        yield f"{FOLDER}/src/{self.name}.cpp", render(f"cpp/{template}.cpp.j2", file=self, **view)
