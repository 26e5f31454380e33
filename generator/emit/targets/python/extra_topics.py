"""Generated handlers of topics with a standard message such as sensor_msgs/msg/Imu.

These are the extra topics, and the topics of rows with a standard message.
"""

from __future__ import annotations

from roverlink.generator import ir
from roverlink.generator.emit.extra_topic_names import named_extra_topics
from roverlink.generator.emit.render import Files, header, render
from roverlink.generator.emit.targets.python import interfaces, spelling
from roverlink.generator.emit.targets.python.imports import Import, import_lines
from roverlink.generator.emit.targets.python.packages import package_file
from roverlink.generator.emit.targets.python.standard_expressions import StandardSpeller
from roverlink.generator.ir import StandardTopic


def emit(bridge: ir.Bridge) -> Files:
    """Yield a module for each handler, and the ``__init__.py`` of the extra topics' package."""
    for route in bridge.routes:
        if route.standard:
            text = _handler(bridge, route, route.standard, spelling.handler_class(route), is_extra=False)
            yield f"generated/handlers/{spelling.module(route.name)}.py", text
    named = named_extra_topics(bridge)
    for extra in named:
        text = _handler(bridge, extra.route, extra.standard, extra.name, is_extra=True)
        yield f"generated/extra_topics/{extra.file}.py", text
    if named:
        docstring = "Extra topics of the rows, with standard messages: one handler class for each topic."
        classes = {extra.name: extra.file for extra in named}
        yield package_file(bridge, "extra_topics", docstring, classes)


def _handler(bridge: ir.Bridge, route: ir.Route, standard: StandardTopic, name: str, *, is_extra: bool) -> str:
    speller = StandardSpeller(standard, bridge.python_package)
    to_ros, angles = speller.arguments(standard.fields), tuple(speller.angles())
    from_ros = () if standard.obstacle else speller.recovered()
    module = spelling.proto_module(standard.file)
    imports: set[Import] = {
        *speller.imports,
        *speller.table_imports,
        *spelling.route_imports(route),
        (spelling.proto_package(bridge.python_package, standard.file), module),
        ("roverlink.runtime.core.standard_handler", "StandardHandler"),
        ("roverlink.runtime.core.standard_handler", "UNSTAMPED"),
        ("roverlink.runtime.interfaces", "Time"),
    }
    board_stamp = standard.board_stamp
    if board_stamp is not None:
        imports.add(("roverlink.runtime.core.handler", "BoardStamp"))
    if standard.obstacle:
        imports.add(("roverlink.runtime.core.errors", "ConversionError"))
    spelled = [argument.value for argument in (*to_ros, *from_ros)]
    return render(
        "extra_topic.py.j2",
        header=header(f"{bridge.table} (row {route.name}) and {standard.file}"),
        imports=import_lines(imports),
        uses_math=any("math." in text for text in (*spelled, *speller.constants.values())),
        constants=speller.constants,
        tables=speller.tables.values(),
        inverse_tables=speller.inverse_tables.values(),
        handler=name,
        about=spelling.documented(route.comment, f"{standard.local_name} as {standard.message}."),
        route=route,
        is_extra=is_extra,
        default_qos=ir.Qos(),
        proto=standard.local_name,
        ros=standard.message,
        refusal=standard.refusal,
        lost=standard.lost,
        payload=f"{module}.{standard.local_name}",
        message=interfaces.reference(standard.message),
        to_ros=to_ros,
        takes_payload=any("payload." in argument.value for argument in to_ros),
        takes_stamp=speller.takes_stamp,
        board_stamp=board_stamp,
        angles=angles,
        from_ros=from_ros,
    )
