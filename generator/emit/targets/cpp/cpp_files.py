"""The header and the source file of a generated class."""

from __future__ import annotations

from dataclasses import dataclass

from roverlink.generator.emit.render import Files, header, render

FOLDER = "generated/cpp"


@dataclass(frozen=True, slots=True)
class CppFile:
    """A header, and the source file of the same name where it has one."""

    package: str
    name: str
    """With its folder: ``handlers/imu_info``."""
    origin: str
    """What it is generated from."""

    @property
    def top(self) -> str:
        """The lines that open it."""
        return header(self.origin, "//")

    @property
    def include(self) -> str:
        """The header, as an include directive names it."""
        return f"{self.package}/{self.name}.hpp"

    @property
    def guard(self) -> str:
        """The macro that guards the header: ``COMMS__HANDLERS__IMU_INFO_HPP_``."""
        return self.include.replace("/", "__").replace(".", "_").upper() + "_"

    def header(self, template: str, **view: object) -> Files:
        """Yield the header, made by a template."""
        yield f"{FOLDER}/include/{self.include}", render(f"cpp/{template}.hpp.j2", file=self, **view)

    def source(self, template: str, **view: object) -> Files:
        """Yield the source file, made by a template."""
        yield f"{FOLDER}/src/{self.name}.cpp", render(f"cpp/{template}.cpp.j2", file=self, **view)
