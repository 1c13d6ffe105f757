"""Trials: the map replayed with other parameters, compared with its replay as it was."""

from __future__ import annotations

from typing import Annotated

from fastapi import APIRouter, Path

from server.routes.access import ServicesDep, ViewDep
from server.schemas import KeepTrial, KeptTrial, StartTrial, TakenOver, Trial, TrialOutcome, Trials

router = APIRouter(prefix="/api/maps/{map}/trials", tags=["trials"])

Number = Annotated[int, Path(ge=1, le=2**31 - 1)]


@router.get("")
def get_trials(services: ServicesDep, view: ViewDep) -> Trials:
    """All trials of this map, the newest first."""
    return Trials(trials=services.trials.of(view))


@router.post("")
def start_trial(services: ServicesDep, view: ViewDep, trial: StartTrial) -> Trial:
    """Try parameters: the map's nodes are replayed from what is stored of them, and the map stays as it is."""
    return services.start_trial(view, trial.changes)


@router.get("/{number}")
def get_trial(services: ServicesDep, view: ViewDep, number: Number) -> TrialOutcome:
    """A trial, and both sides of its comparison once it is done."""
    return services.trials.outcome(view, number)


@router.post("/{number}/cancel")
def cancel_trial(services: ServicesDep, view: ViewDep, number: Number) -> Trials:
    """Stop a trial; nothing of it stays. Answers with those that are left."""
    services.trials.cancel(view, number)
    return Trials(trials=services.trials.of(view))


@router.post("/{number}/discard")
def discard_trial(services: ServicesDep, view: ViewDep, number: Number) -> Trials:
    """Forget a trial. Answers with those that are left."""
    services.trials.discard(view, number)
    return Trials(trials=services.trials.of(view))


@router.post("/{number}/take-over")
async def take_over_trial(services: ServicesDep, view: ViewDep, number: Number) -> TakenOver:
    """Give the map the trial's parameters: the running engine from now on, else the file for its next session."""
    return await services.take_over(view, number)


@router.post("/{number}/keep")
def keep_trial(services: ServicesDep, view: ViewDep, number: Number, keep: KeepTrial) -> KeptTrial:
    """Make a new map file of a trial, in the first served folder; a file of that name is never replaced."""
    return KeptTrial(map=services.keep_trial(view, number, keep.name))
