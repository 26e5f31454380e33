# Generated from mapping.yaml (row shelf) and stock.proto; do not edit.
# Regenerate with: roverlink generate
"""Handler of the row shelf: Shelf and rover/msg/Shelf."""

from __future__ import annotations

from google.protobuf import field_mask_pb2, wrappers_pb2

from generated.conversions import any_, box, empty
from generated.messages import (
    Colour,
    Shelf,
    ShelfAgesEntry,
    ShelfAnythingEntry,
    ShelfBoxesEntry,
    ShelfColoursEntry,
    ShelfCountsEntry,
    ShelfLabelsEntry,
    ShelfMasksEntry,
    ShelfNotesEntry,
    ShelfNothingEntry,
    ShelfPricesEntry,
    ShelfPrintsEntry,
    ShelfSeenEntry,
    ShelfStatesEntry,
    ShelfTemperaturesEntry,
)
from generated.pb2 import stock_pb2
from roverlink.runtime.convert.maps import mapping
from roverlink.runtime.convert.well_known import duration, json_value, timestamp
from roverlink.runtime.core.handler import Handler, Route


class ShelfHandler(Handler[stock_pb2.Shelf, Shelf]):
    """Shelf as rover/msg/Shelf.

    Number 1 of the envelope, board_to_ros, topic shelf.
    """

    route = Route(
        number=1,
        name="shelf",
        topic="shelf",
        direction="board_to_ros",
    )
    payload_type = stock_pb2.Shelf
    message_type = Shelf

    @staticmethod
    def to_ros(payload: stock_pb2.Shelf) -> Shelf:
        """Convert Shelf to rover/msg/Shelf."""
        return Shelf(
            boxes=[
                ShelfBoxesEntry(key=key, value=box.to_ros(value))
                for key, value in sorted(payload.boxes.items())
            ],
            how_many=[
                ShelfCountsEntry(key=key, value=value)
                for key, value in sorted(payload.counts.items())
            ],
            colours=[
                ShelfColoursEntry(key=key, value=Colour(colour=value))
                for key, value in sorted(payload.colours.items())
            ],
            states=[
                ShelfStatesEntry(key=key, value=value)
                for key, value in sorted(payload.states.items())
            ],
            labels=[
                ShelfLabelsEntry(key=key, value=value)
                for key, value in sorted(payload.labels.items())
            ],
            seen=[
                ShelfSeenEntry(key=key, value=timestamp.to_ros(value, "seen"))
                for key, value in sorted(payload.seen.items())
            ],
            ages=[
                ShelfAgesEntry(key=key, value=duration.to_ros(value, "ages"))
                for key, value in sorted(payload.ages.items())
            ],
            prices=[
                ShelfPricesEntry(key=key, value=value.value)
                for key, value in sorted(payload.prices.items())
            ],
            prints=[
                ShelfPrintsEntry(key=key, value=value.value)
                for key, value in sorted(payload.prints.items())
            ],
            notes=[
                ShelfNotesEntry(key=key, value=json_value.to_ros(value, "notes"))
                for key, value in sorted(payload.notes.items())
            ],
            masks=[
                ShelfMasksEntry(key=key, value=list(value.paths))
                for key, value in sorted(payload.masks.items())
            ],
            nothing=[
                ShelfNothingEntry(key=key, value=empty.to_ros(value))
                for key, value in sorted(payload.nothing.items())
            ],
            anything=[
                ShelfAnythingEntry(key=key, value=any_.to_ros(value))
                for key, value in sorted(payload.anything.items())
            ],
            temperatures=[
                ShelfTemperaturesEntry(key=key, value=value)
                for key, value in sorted(payload.temperatures.items())
            ],
        )

    @staticmethod
    def from_ros(message: Shelf) -> stock_pb2.Shelf:
        """Convert rover/msg/Shelf to Shelf."""
        return stock_pb2.Shelf(
            boxes=mapping(
                ((item.key, box.from_ros(item.value)) for item in message.boxes),
                "boxes",
            ),
            counts=mapping(
                ((item.key, item.value) for item in message.how_many), "how_many"
            ),
            colours=mapping(
                ((item.key, item.value.colour) for item in message.colours), "colours"
            ),
            states=mapping(
                ((item.key, item.value) for item in message.states), "states"
            ),
            labels=mapping(
                ((item.key, item.value) for item in message.labels), "labels"
            ),
            seen=mapping(
                (
                    (item.key, timestamp.from_ros(item.value, "seen"))
                    for item in message.seen
                ),
                "seen",
            ),
            ages=mapping(
                (
                    (item.key, duration.from_ros(item.value, "ages"))
                    for item in message.ages
                ),
                "ages",
            ),
            prices=mapping(
                (
                    (item.key, wrappers_pb2.DoubleValue(value=item.value))
                    for item in message.prices
                ),
                "prices",
            ),
            prints=mapping(
                (
                    (item.key, wrappers_pb2.BytesValue(value=item.value))
                    for item in message.prints
                ),
                "prints",
            ),
            notes=mapping(
                (
                    (item.key, json_value.from_ros(item.value, "notes"))
                    for item in message.notes
                ),
                "notes",
            ),
            masks=mapping(
                (
                    (item.key, field_mask_pb2.FieldMask(paths=item.value))
                    for item in message.masks
                ),
                "masks",
            ),
            nothing=mapping(
                ((item.key, empty.from_ros(item.value)) for item in message.nothing),
                "nothing",
            ),
            anything=mapping(
                ((item.key, any_.from_ros(item.value)) for item in message.anything),
                "anything",
            ),
            temperatures=mapping(
                ((item.key, item.value) for item in message.temperatures),
                "temperatures",
            ),
        )
