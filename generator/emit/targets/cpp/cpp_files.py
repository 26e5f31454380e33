"""Header and source file of a generated class."""

from __future__ import annotations

from dataclasses import dataclass

from roverlink.generator.emit.render import Files, header, render

FOLDER = "generated/cpp"


@dataclass(frozen=True, slots=True)
class CppFile:
    """Header, and the source file of the same name if there is one."""

    package: str
    name: str
    """Path without suffix: ``handlers/imu_info``."""
    origin: str
    """Origin of the file, for its header comment."""

    @property
    def top(self) -> str:
        """Comment lines that open the file."""
        return header(self.origin, "//")

    @property
    def include(self) -> str:
        """Path of the header in an include directive."""
        return f"{self.package}/{self.name}.hpp"

    @property
    def guard(self) -> str:
        """Include guard of the header: ``COMMS__HANDLERS__IMU_INFO_HPP_``."""
        return self.include.replace("/", "__").replace(".", "_").upper() + "_"

    def header(self, template: str, **view: object) -> Files:
        """Yield the header, rendered from a template."""
        yield f"{FOLDER}/include/{self.include}", render(f"cpp/{template}.hpp.j2", file=self, **view)

    def source(self, template: str, **view: object) -> Files:
        """Yield the source file, rendered from a template."""
        yield f"{FOLDER}/src/{self.name}.cpp", render(f"cpp/{template}.cpp.j2", file=self, **view)
