"""Parameter services of a ROS 2 node (package rcl_interfaces), which `ros2 param` calls: the response to each request.

The services answer as rclpy's node does: a request that names an unknown parameter gets an empty response.
"""

from __future__ import annotations

import logging
import time
from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

from roverlink.runtime.core import cdr
from roverlink.runtime.core.errors import ConversionError, SetupError
from roverlink.runtime.core.handler import Qos
from roverlink.runtime.core.messages import Message
from roverlink.runtime.interfaces import Time
from roverlink.runtime.interfaces import rcl_interfaces as rcl
from roverlink.runtime.middleware.protocol import Middleware, NodeIdentity, NodeParameters, Respond

PARAMETERS_QOS = Qos(depth=1000)  # rmw_qos_profile_parameters and rmw_qos_profile_parameter_events
_VALUE_FIELDS = {
    rcl.ParameterValue.BOOL: "bool_value",
    rcl.ParameterValue.INTEGER: "integer_value",
    rcl.ParameterValue.DOUBLE: "double_value",
    rcl.ParameterValue.STRING: "string_value",
}
"""Field of a ParameterValue that has the value, by the parameter's type. No parameter of our nodes is an array."""
_TYPES = {
    bool: rcl.ParameterValue.BOOL,
    int: rcl.ParameterValue.INTEGER,
    float: rcl.ParameterValue.DOUBLE,
    str: rcl.ParameterValue.STRING,
}


class Service(NamedTuple):
    """Service of a node: its name below the node's name, the message types, and the function that answers."""

    name: str
    request: type[Message]
    response: type[Message]
    answer: Callable[[Any], Message]


class ParameterServices:
    """Answers to the requests for the parameters of one node."""

    def __init__(self, parameters: NodeParameters, publish: Callable[[Sequence[rcl.Parameter]], None]) -> None:
        """Answer from ``parameters``; ``publish`` is called with parameters that have changed."""
        self._parameters, self._publish = parameters, publish

    def change(self, changes: Mapping[str, Any]) -> None:
        """Change all parameters together, or none of them. Raises `SetupError` with the reason for none."""
        self._parameters.change(changes)
        self._publish([rcl.Parameter(name, _to_message(value)) for name, value in changes.items()])

    def services(self) -> tuple[Service, ...]:
        """Return the services that every ROS 2 node has for its parameters."""
        return (
            Service("list_parameters", rcl.ListParametersRequest, rcl.ListParametersResponse, self._list),
            Service("get_parameters", rcl.GetParametersRequest, rcl.GetParametersResponse, self._get),
            Service("get_parameter_types", rcl.GetParameterTypesRequest, rcl.GetParameterTypesResponse, self._types),
            Service(
                "describe_parameters", rcl.DescribeParametersRequest, rcl.DescribeParametersResponse, self._describe
            ),
            Service("set_parameters", rcl.SetParametersRequest, rcl.SetParametersResponse, self._set),
            Service(
                "set_parameters_atomically",
                rcl.SetParametersAtomicallyRequest,
                rcl.SetParametersAtomicallyResponse,
                self._set_atomically,
            ),
        )

    def _list(self, request: rcl.ListParametersRequest) -> rcl.ListParametersResponse:
        names = [name for name in self._parameters.values if _is_listed(name, request)]
        prefixes = dict.fromkeys(name.rpartition(".")[0] for name in names if "." in name)
        return rcl.ListParametersResponse(rcl.ListParametersResult(names, list(prefixes)))

    def _get(self, request: rcl.GetParametersRequest) -> rcl.GetParametersResponse:
        return rcl.GetParametersResponse(
            [_to_message(value) for value in _all_or_none(self._parameters.values, request.names)]
        )

    def _types(self, request: rcl.GetParameterTypesRequest) -> rcl.GetParameterTypesResponse:
        descriptors = _all_or_none(self._parameters.descriptors, request.names)
        return rcl.GetParameterTypesResponse(bytes(descriptor.type for descriptor in descriptors))

    def _describe(self, request: rcl.DescribeParametersRequest) -> rcl.DescribeParametersResponse:
        return rcl.DescribeParametersResponse(_all_or_none(self._parameters.descriptors, request.names))

    def _set(self, request: rcl.SetParametersRequest) -> rcl.SetParametersResponse:
        return rcl.SetParametersResponse([self._change([parameter]) for parameter in request.parameters])

    def _set_atomically(self, request: rcl.SetParametersAtomicallyRequest) -> rcl.SetParametersAtomicallyResponse:
        return rcl.SetParametersAtomicallyResponse(self._change(request.parameters))

    def _change(self, parameters: Sequence[rcl.Parameter]) -> rcl.SetParametersResult:
        """Change all parameters together, or none of them."""
        try:
            self.change({parameter.name: _from_message(parameter.value) for parameter in parameters})
        except SetupError as error:
            return rcl.SetParametersResult(successful=False, reason=str(error))
        return rcl.SetParametersResult(successful=True)


def answering(service: Service) -> Callable[[bytes, Respond], None]:
    """Return the function that answers serialized requests of a service that has its answers at once."""

    def answer(data: bytes, respond: Respond) -> None:
        try:
            request = cdr.decode(service.request, data)
        except ConversionError as error:
            logging.getLogger("roverlink").warning("request to %s ignored: %s", service.name, error)
        else:
            respond(cdr.encode(service.answer(request)))

    return answer


def parameter_events(middleware: Middleware, node: NodeIdentity) -> Callable[[Sequence[rcl.Parameter]], None]:
    """Return a function that publishes changed parameters of a node, as every ROS 2 node does."""
    events = middleware.publisher("/parameter_events", rcl.ParameterEvent, PARAMETERS_QOS)

    def publish(changed: Sequence[rcl.Parameter]) -> None:
        stamp = Time.since_1970(time.time_ns())
        events.publish([cdr.encode(rcl.ParameterEvent(stamp, node.full_name, changed_parameters=list(changed)))])

    return publish


def _is_listed(name: str, request: rcl.ListParametersRequest) -> bool:
    """Return true if a ListParameters request asks for the parameter ``name``.

    It does if the name is one of the request's prefixes, or begins with a prefix and has at most ``depth`` more parts
    (0 for any number). Without prefixes, the whole name may have at most ``depth`` parts.
    """

    def shallow_enough(rest: str) -> bool:
        return request.depth == 0 or rest.count(".") < request.depth

    if not request.prefixes:
        return shallow_enough(name)
    return name in request.prefixes or any(
        name.startswith(f"{prefix}.") and shallow_enough(name.removeprefix(f"{prefix}.")) for prefix in request.prefixes
    )


def _all_or_none(by_name: Mapping[str, Any], names: Sequence[str]) -> list[Any]:
    """Return the values of ``by_name`` for all names, or an empty list if one of the names is unknown."""
    return [by_name[name] for name in names] if all(name in by_name for name in names) else []


def _to_message(value: Any) -> rcl.ParameterValue:
    message = rcl.ParameterValue(_TYPES[type(value)])
    setattr(message, _VALUE_FIELDS[message.type], value)
    return message


def _from_message(value: rcl.ParameterValue) -> Any:
    """Return the Python value of a parameter; None if the parameter is not set or is an array."""
    return getattr(value, _VALUE_FIELDS[value.type]) if value.type in _VALUE_FIELDS else None
