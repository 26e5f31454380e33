"""Checkpoint of a training: the network after the newest epoch, from which the training can go on."""

from __future__ import annotations

import json
import zipfile
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from roverkit.objects.training.learning import Learnt
from roverlink.runtime.atomic_files import replacing
from roverlink.runtime.core.errors import SetupError


@dataclass(frozen=True, slots=True)
class Plan:
    """Training to which a checkpoint belongs; it goes on only with the same images and options."""

    images: tuple[str, ...]
    """Names of the files, in their order."""
    names: tuple[str, ...]
    size: tuple[int, int]
    epochs: int
    seed: int

    @property
    def text(self) -> str:
        """JSON of the plan."""
        return json.dumps(asdict(self))


def checkpoint_of(model: Path) -> Path:
    """Return the path of the checkpoint beside a model."""
    return model.with_name(f"{model.name}.checkpoint")


def write_checkpoint(path: Path, plan: Plan, learnt: Learnt) -> None:
    """Write a checkpoint. Raises `SetupError` if that is not possible."""
    arrays: dict[str, Any] = {f"weights {name}": array for name, array in learnt.weights.items()}
    arrays |= {f"statistics {name}": array for name, array in learnt.statistics.items()}
    arrays |= {f"state {index}": array for index, array in enumerate(learnt.state)}
    try:
        with replacing(path) as part, part.open("wb") as file:
            np.savez(file, plan=np.array(plan.text), epochs=np.array(learnt.epochs), **arrays)
    except OSError as error:
        raise SetupError(f"{path}: cannot write the checkpoint: {error.strerror or error}") from error


def read_checkpoint(path: Path, plan: Plan) -> Learnt:
    """Read a checkpoint. Raises `SetupError` if there is none, or if it is of another training."""
    try:
        with np.load(path, allow_pickle=False) as file:
            arrays = dict(file)
        if str(arrays.pop("plan")) != plan.text:
            raise SetupError(f"{path} is of other images or options; give those, or leave --resume out")
        parts: dict[str, dict[str, Any]] = {"weights": {}, "statistics": {}, "state": {}}
        epochs = int(arrays.pop("epochs"))
        for key, array in arrays.items():
            kind, _, name = key.partition(" ")
            parts[kind][name] = array
        state = [parts["state"][str(index)] for index in range(len(parts["state"]))]
    except FileNotFoundError as error:
        raise SetupError(f"{path}: there is no checkpoint; leave --resume out") from error
    except (OSError, ValueError, KeyError, EOFError, zipfile.BadZipFile) as error:
        raise SetupError(f"{path}: the checkpoint is damaged ({error}); leave --resume out") from error
    return Learnt(epochs, parts["weights"], parts["statistics"], state)
