"""Catalogue of a ROS 2 distribution: facts about the classes of all packages, joined along base classes and members."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from check_launch.catalogue.facts import (
    Catalogue,
    Endpoint,
    NodeClass,
    Package,
    Parameter,
    ParameterSet,
    Plugin,
    PluginSlot,
    SharedParameters,
    Source,
    SubNode,
    Transform,
)
from check_launch.extraction.class_facts import NODE_CLASSES, ClassFacts, EndpointFact
from check_launch.extraction.package_facts import PackageFacts, read_packages
from check_launch.extraction.rtabmap_parameters import core_parameters
from check_launch.extraction.supplement import Supplement

_OWN_NAME = re.compile(r"^\{(?:plugin_name_?|_?name_?|behavior_name_|getName\(\))\}\.")
_IN_PLUGIN = re.compile(r"^\{dwb_plugin_name_\}\.\{name_\}\.")
"""Beginning of the parameters of a critic, which is a plugin in a plugin."""
_PLACEHOLDER = re.compile(r"\{([^{}]*)\}")
_WHOLE = re.compile(r"^\{[\w.()>-]+\}")
_VALUE = re.compile(r"\$\(([^()]*(?:\(\))?[^()]*)\)")
_TESTS = re.compile(r"test|benchmark|system_tests|visual_testing|examples_tf2_py")
_KNOWN = re.compile(r"^[\w#]+$")


@dataclass(frozen=True, slots=True)
class Checkout:
    """A folder with the sources of one repository, at one commit."""

    name: str
    folder: Path
    source: Source
    packages: Mapping[str, Path]
    """Folders of its packages, by their names."""
    is_supplemented: bool = True
    """False if supplement.yaml does not state what the program does not understand of these packages.

    Then classes that may have more parameters or topics, and packages that may have more executables, are marked."""


def _in_package(package: str, class_name: str) -> str:
    """Return the name of a class of which another package has one of the same name."""
    return f"package {package}::{class_name}"


def _other_texts(facts: PackageFacts) -> frozenset[str]:
    """Return the texts in a package's sources that are no names of the parameters and topics that were understood."""
    known = {name for one in facts.classes.values() for name in one.parameters}
    known |= {end.name for one in facts.classes.values() for end in one.endpoints}
    return frozenset(facts.texts) - known - {name.rpartition(".")[2] for name in known}


def packages_in(folder: Path) -> dict[str, Path]:
    """Return the folders of the packages in a checkout that build something, without tests and examples."""
    found: dict[str, Path] = {}
    for manifest in sorted(folder.rglob("package.xml")):
        package = manifest.parent
        if not _TESTS.search(package.relative_to(folder).as_posix()) and (
            (package / "CMakeLists.txt").is_file() or (package / "setup.py").is_file()
        ):
            name = re.search(r"<name>\s*([\w-]+)\s*</name>", manifest.read_text(encoding="utf-8"))
            found[name[1] if name else package.name] = package
    return found


class Assembler:
    """Joins the facts of all packages to those of whole nodes and plugins."""

    def __init__(
        self,
        checkouts: Iterable[Checkout],
        supplement: Supplement,
        read: Callable[[Sequence[Path]], Mapping[Path, PackageFacts]] = read_packages,
    ) -> None:
        """``read`` returns the facts of the packages in folders."""
        self._supplement = supplement
        self._packages: dict[str, tuple[Path, Checkout]] = {}
        self._facts: dict[str, PackageFacts] = {}
        self._classes: dict[str, ClassFacts] = {}
        self._sets: dict[str, ParameterSet] = {}
        self.unexplained: set[str] = set()
        """Names of parameters with variables that supplement.yaml has to explain."""
        self._partial: set[str] = set()
        self._with_marks: set[str] = set()  # classes of packages that the supplement does not complete
        self._other_texts: dict[str, frozenset[str]] = {}
        self._sources: dict[str, Source] = {}
        self._of_plugins: set[str] = set()
        self._complete: set[str] = set()  # plugins of packages that the supplement completes
        self._distribution = ""
        for checkout in sorted(checkouts, key=lambda checkout: checkout.name):
            self._sources[checkout.name] = checkout.source
            if (checkout.folder / "corelib/include/rtabmap/core/Parameters.h").is_file():
                self._sets["rtabmap"] = core_parameters(checkout.folder)
            for name, folder in checkout.packages.items():
                self._packages[name] = folder, checkout
        found = read([folder for package, (folder, _) in self._packages.items() if package != "rtabmap"])
        for package, (folder, checkout) in self._packages.items():
            self._facts[package] = found.get(folder) or PackageFacts()
            other_texts = _other_texts(self._facts[package])
            for class_name, of_class in self._facts[package].classes.items():
                if checkout.is_supplemented:
                    self._classes.setdefault(class_name, of_class)
                else:  # packages of strangers have classes of the same name, such as `Teleop`
                    name = _in_package(package, class_name) if class_name in self._classes else class_name
                    self._classes[name] = of_class
                    self._with_marks.add(name)
                    self._other_texts[name] = other_texts
        self._short: dict[str, list[str]] = {}
        for class_name in self._classes:
            self._short.setdefault(class_name.rpartition("::")[2], []).append(class_name)

    def catalogue(self, distribution: str, launch_files: Mapping[str, Mapping[str, Any]]) -> Catalogue:
        """Return the catalogue; ``launch_files`` are descriptions of launch files, by package and path."""
        plugins = {name: plugin for facts in self._facts.values() for name, plugin in facts.plugins.items()}
        packages = {name: self._package(name, launch_files.get(name, {})) for name in sorted(self._packages)}
        self._add_programs_without_class()
        wanted = {
            name
            for package in packages.values()
            for name in (*package.executables.values(), *package.components.values())
        }
        wanted |= {node.get("class", "") for nodes in self._supplement.nodes.values() for node in nodes}
        of_plugins = self._of_plugins = {plugin.class_name for plugin in plugins.values()}
        self._complete = {
            plugin.class_name
            for name, facts in self._facts.items()
            if self._packages[name][1].is_supplemented
            for plugin in facts.plugins.values()
        }
        self._distribution = distribution
        classes = {
            name: self._joined(self._resolved(name, "") or name, name in of_plugins)
            for name in sorted((wanted | of_plugins) - {""})
        }
        classes = {name: facts for name, facts in classes.items() if facts is not None}
        return Catalogue(
            distribution,
            self._sources,
            {
                name: package
                for name, package in packages.items()
                if not self._packages[name][1].is_supplemented
                or _is_useful(package, name, plugins)
                or name in self._sets
            },
            {name: facts for name, facts in classes.items() if facts},
            dict(sorted(plugins.items())),
            self._sets,
        )

    def folders(self) -> Iterator[tuple[str, Path]]:
        """Yield the name and the folder of each package."""
        for name, (folder, _) in sorted(self._packages.items()):
            yield name, folder

    def _package(self, name: str, launch_files: Mapping[str, Any]) -> Package:
        facts = self._facts[name]
        programs = {
            program: self._resolved(class_name, _in_package(name, "")) or "" if class_name else ""
            for program, class_name in facts.programs.items()
        }
        if not self._packages[name][1].is_supplemented:  # a class that is no node is a part of one that was not found
            programs = {
                program: class_name if class_name not in self._classes or self._is_node(class_name) else ""
                for program, class_name in programs.items()
            }
        stated = {
            key.partition("/")[2]: value
            for key, value in self._supplement.programs.items()
            if key.startswith(f"{name}/")
        }
        own = _in_package(name, "")
        components = {component: self._resolved(component, own) or component for component in facts.components}
        return Package(
            name,
            facts.version,
            self._packages[name][1].name,
            {**programs, **stated},
            components,
            dict(launch_files),
            facts.is_partial and not self._packages[name][1].is_supplemented,
            frozenset(facts.build_words),
        )

    def _add_programs_without_class(self) -> None:
        """Give a class to programs whose facts stand in the supplement alone."""
        for name in self._supplement.programs.values():
            self._classes.setdefault(name, ClassFacts(name))
            self._short.setdefault(name.rpartition("::")[2], []).append(name)

    def _resolved(self, written: str, owner: str) -> str | None:
        """Return the qualified name of a class that is written in a class of the namespace ``owner``."""
        namespace = owner
        while namespace:
            namespace = namespace.rpartition("::")[0]
            if namespace and f"{namespace}::{written}" in self._classes:
                return f"{namespace}::{written}"
        if written in self._classes:
            return written
        candidates = self._short.get(written.rpartition("::")[2], [])
        fitting = [name for name in candidates if name == written or name.endswith(f"::{written}")]
        known = fitting or (
            [name for name in candidates if name.startswith(owner.partition("::")[0] + "::")] if owner else []
        )
        fitting.sort(key=lambda name: not name.startswith(owner))  # of several, the one of the same package
        return known[0] if len(known) == 1 else fitting[0] if fitting else None

    def _joined(self, name: str, is_plugin: bool) -> NodeClass | None:
        facts = self._classes.get(name)
        if facts is None:
            return NodeClass(name, is_partial=name not in self._complete)  # its declaration was not read
        members = list(self._members(name, set()))
        parameters: dict[str, Parameter] = {}
        of_node: dict[str, Parameter] = {}
        of_parent: dict[str, Parameter] = {}
        endpoints: list[Endpoint] = []
        topics_stated: list[Mapping[str, Any]] = []
        for member, topics in members:
            for key, parameter in self._parameters_of(member):
                if key.startswith("{parent}."):
                    of_parent[key.removeprefix("{parent}.")] = parameter
                    continue
                relative = key.removeprefix("{plugin}.")
                kept = parameters if (relative != key) == is_plugin else of_node
                if relative != key and not is_plugin:
                    self.unexplained.add(f"{name}: {key} (of {member})")
                    self._partial.add(name)
                    continue
                known = kept.get(relative)
                kept[relative] = _merged(known, parameter) if known else parameter
            for name_of_none in self._supplement.absent.get(member, []):
                parameters.pop(name_of_none, None)
                of_node.pop(name_of_none, None)
            endpoints += self._endpoints_of(member, topics)
            topics_stated += filter(self._is_for, self._supplement.topics.get(member, []))
        if not is_plugin:
            parameters |= {**of_node}
            of_node = {}
        names = [member for member, _ in members]
        all_declared = {**parameters, **of_node, **of_parent}
        valued = {name for name, parameter in all_declared.items() if parameter.default is not None}
        endpoints = [
            endpoint if set(_VALUE.findall(endpoint.when)) <= valued else replace(endpoint, when="")
            for endpoint in endpoints
        ]
        default = next(filter(None, (self._classes[member].default_name for member in names)), "")
        return NodeClass(
            name,
            default if self._is_node(name) else "",
            dict(sorted(parameters.items())),
            dict(sorted(of_node.items())),
            dict(sorted(of_parent.items())),
            _with_stated(endpoints, topics_stated),
            tuple(
                _slot(slot)
                for member in names
                for slot in self._supplement.slots.get(member, [])
                if slot["parameter"] in parameters
            ),
            tuple(
                SubNode(
                    node.get("name", ""),
                    node.get("namespace", ""),
                    node.get("class", ""),
                    node.get("type_parameter", ""),
                )
                for member in names
                for node in self._supplement.nodes.get(member, [])
            ),
            tuple(
                Transform(transform["parent"], transform["child"], transform.get("when", ""))
                for member in names
                for transform in self._supplement.transforms.get(member, [])
            ),
            tuple(frame for member in names for frame in self._supplement.frames.get(member, [])),
            tuple(
                SharedParameters(stated["set"], tuple(stated.get("groups", ())), tuple(stated.get("without", ())))
                for member in names
                if (stated := self._supplement.sets.get(member))
            ),
            name in self._supplement.open_topics,
            next((arguments for member in names if (arguments := self._supplement.arguments.get(member))), {}),
            is_partial=name in self._with_marks and any(map(self._is_partial, names)),
            other_texts=frozenset().union(*(self._other_texts.get(member, ()) for member in names)),
        )

    def _is_partial(self, name: str) -> bool:
        """Return true if a class may declare more than was understood: also with base classes that were not read."""
        bases = (base for base in self._classes[name].bases if base.rpartition("::")[2] not in NODE_CLASSES)
        return (
            self._classes[name].is_partial
            or name in self._partial
            or any(self._resolved(base, name) is None for base in bases)
        )

    def _members(self, name: str, seen: set[str]) -> Iterator[tuple[str, Sequence[str]]]:
        """Yield a class, its base classes, and the classes of its members, each with the topics that it gets."""
        if name in seen or name not in self._classes:
            return
        seen.add(name)
        yield name, ()
        facts = self._classes[name]
        for base in facts.bases:
            if found := self._resolved(base, name):
                yield from self._members(found, seen)
        parts = {**facts.parts, **{part: set[str]() for part in self._supplement.parts.get(name, [])}}
        for written, topics in sorted(parts.items()):
            part = self._resolved(written, name)
            if part is None or self._is_node(part) or part in seen or part in self._of_plugins:
                continue
            inner = list(self._members(part, seen))
            yield from ((key, sorted(topics) if key == part else given) for key, given in inner)

    def _is_node(self, name: str) -> bool:
        # Grows by base classes of base classes, each once: a wrong file may derive two classes from each other.
        reached = [name]
        for class_name in reached:
            for base in self._classes[class_name].bases:
                if base.rpartition("::")[2] in NODE_CLASSES:
                    return True
                if (found := self._resolved(base, class_name)) and found not in reached:
                    reached.append(found)
        return False

    def _parameters_of(self, name: str) -> Iterator[tuple[str, Parameter]]:
        facts = self._classes[name]
        declared = {key: fact.stated or Parameter(fact.type, fact.default) for key, fact in facts.parameters.items()}
        for key, parameter in declared.items():
            for spelled in self._spelled(key, name):
                yield spelled, parameter
        is_plugin = any(
            key.startswith("{plugin}.") for parameter in facts.parameters for key in self._spelled(parameter, name)
        )
        prefix = "{plugin}." if is_plugin else ""
        for key, stated in self._supplement.parameters.get(name, {}).items():
            if self._is_for(stated):
                parameter = _parameter(stated, self._distribution)
                # A workspace may have another version of the package, with other types and ranges.
                is_certain = name not in self._with_marks
                yield prefix + key, parameter if is_certain else Parameter("", parameter.default)
        if self._is_node(name) and not prefix:
            for key, stated in self._supplement.parameters[""].items():
                if self._is_for(stated):
                    yield key, _parameter(stated, self._distribution)

    def _is_for(self, stated: Mapping[str, Any]) -> bool:
        """Return true if a statement of the supplement holds for the distribution."""
        return self._distribution in stated.get("only", [self._distribution])

    def _spelled(self, key: str, owner: str) -> list[str]:
        """Return the spellings of a pattern whose variables are explained; none if another class declares it."""
        stated, facts = self._supplement.names.get(owner, {}), self._classes[owner].parameters
        key = _IN_PLUGIN.sub("{plugin}.", key)
        found = [key]
        for variable in dict.fromkeys(_PLACEHOLDER.findall(key)):
            if variable not in stated:
                continue
            meaning = stated[variable]
            if meaning is None:
                return []
            texts = meaning if isinstance(meaning, list) else [meaning or "{plugin}"]
            found = [pattern.replace(f"{{{variable}}}", text) for pattern in found for text in texts]
        found = [_OWN_NAME.sub("{plugin}.", pattern) for pattern in found]
        for pattern in found:
            unknown = [
                v
                for v in _PLACEHOLDER.findall(pattern)
                if v not in ("#", "plugin", "parent", *facts) and f"{{{v}}}" not in _texts(stated)
            ]
            if unknown:
                self.unexplained.add(f"{owner}: {pattern}")
                self._partial.add(owner)
                return []
        return found

    def _endpoints_of(self, name: str, topics: Sequence[str]) -> Iterator[Endpoint]:
        for fact in self._classes[name].endpoints:
            for spelled in self._topic_names(fact, name, topics):
                reliability, when = (self._relative(text, name) for text in (fact.reliability, fact.when))
                yield Endpoint(fact.kind, spelled, fact.type, reliability, fact.durability, when)

    def _topic_names(self, fact: EndpointFact, owner: str, topics: Sequence[str]) -> list[str]:
        names = [fact.name]
        if topics and _WHOLE.match(fact.name):
            names = [_WHOLE.sub(topic, fact.name, count=1) for topic in topics]
        stated = self._supplement.names.get(owner, {})
        found: list[str] = []
        for name in names:
            spelled = [self._relative(name, owner)]
            for variable in dict.fromkeys(_PLACEHOLDER.findall(name)):
                if (meaning := stated.get(variable)) is not None:
                    texts = meaning if isinstance(meaning, list) else [meaning]
                    spelled = [pattern.replace(f"{{{variable}}}", text) for pattern in spelled for text in texts]
            found += spelled
        known = [
            pattern
            for pattern in found
            if not (set(_PLACEHOLDER.findall(pattern)) - {"node", "#", "plugin"} - _lists(stated))
        ]
        if len(known) < len(found):
            self._partial.add(owner)
        return known

    def _relative(self, text: str, owner: str) -> str:
        """Remove the plugin's own name from the parameters in a text: ``$({name_}.topic)`` becomes ``$(topic)``."""

        def replaced(match: re.Match[str]) -> str:
            spelled = self._spelled(match[1], owner)
            return f"$({spelled[0].removeprefix('{plugin}.')})" if spelled else match[0]

        return _VALUE.sub(replaced, text)


def _texts(stated: Mapping[str, Any]) -> str:
    return " ".join(str(value) for value in stated.values())


def _lists(stated: Mapping[str, Any]) -> set[str]:
    return set(_PLACEHOLDER.findall(_texts(stated)))


def _merged(first: Parameter, second: Parameter) -> Parameter:
    """Join two facts about one parameter: the first comes from the class itself, or from the supplement."""
    if second.choices or second.minimum is not None or second.maximum is not None:
        first, second = second, first
    default = second.default if first.default is None else first.default
    return replace(first, type=first.type or second.type, default=default)


def _parameter(stated: Mapping[str, Any], distribution: str) -> Parameter:
    default = _for(distribution, stated.get("default"))
    choices = tuple(_for(distribution, stated.get("choices", ())))
    return Parameter(stated.get("type", ""), default, stated.get("minimum"), stated.get("maximum"), choices)


def _for(distribution: str, stated: Any) -> Any:
    return stated[distribution] if isinstance(stated, Mapping) else stated


def _slot(stated: Mapping[str, Any]) -> PluginSlot:
    return PluginSlot(
        stated["parameter"],
        stated["base"],
        stated.get("type", ""),
        tuple(stated.get("spellings", ())),
        stated.get("is_type", False),
    )


def _with_stated(endpoints: Iterable[Endpoint], stated: Iterable[Mapping[str, Any]]) -> tuple[Endpoint, ...]:
    """Add what the supplement states about topics: whole topics, or conditions of those that the sources have."""
    found: dict[tuple[str, str, str], Endpoint] = {}
    for endpoint in endpoints:
        if endpoint.type or endpoint.kind != "publisher":
            place = endpoint.kind, endpoint.name, endpoint.type
            is_same = place not in found or found[place].when == endpoint.when
            found[place] = endpoint if is_same else replace(endpoint, when="")
    for statement in reversed(list(stated)):  # what is stated about the class itself comes first, and has the last word
        key = {
            (kind, name, type_)
            for kind, name, type_ in found
            if kind == statement["kind"] and name == statement["name"] and statement.get("type", type_) == type_
        }
        needed = statement.get("needed", "")
        if not key:
            type_ = statement.get("type", "")
            # The sources give the name that the node then puts into the namespace around its own.
            found.pop((statement["kind"], statement["name"].removeprefix("../"), type_), None)
            found[(statement["kind"], statement["name"], type_)] = Endpoint(
                statement["kind"],
                statement["name"],
                type_,
                statement.get("reliability", ""),
                statement.get("durability", ""),
                statement.get("when", ""),
                needed,
            )
        for at in key:
            known = found[at]
            found[at] = replace(
                known,
                reliability=statement.get("reliability", known.reliability),
                durability=statement.get("durability", known.durability),
                when=statement.get("when", known.when),
                needed=needed,
            )
    return tuple(found[key] for key in sorted(found))


def _is_useful(package: Package, name: str, plugins: Mapping[str, Plugin]) -> bool:
    return bool(
        package.executables
        or package.components
        or package.launch_files
        or any(plugin.package == name for plugin in plugins.values())
    )
