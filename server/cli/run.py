"""``slamdeck run``: map a sequence."""

from __future__ import annotations

import json as json_format
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any

import typer

from server.cli.live import check_target, run_live
from server.cli.options import (
    PORT,
    ConfigOption,
    HostOption,
    NameOption,
    NoTokenOption,
    ParamOption,
    PortOption,
    SeedOption,
    TokenOption,
    parameters,
)
from server.cli.serve import settings_of


def run(
    source: Annotated[str, typer.Argument(help="A folder in TUM RGB-D form, or tour: with options.")],
    db: Annotated[Path, typer.Option(help="Map file to make, or to go on with.")],
    json: Annotated[bool, typer.Option("--json", help="Print the summary as one JSON object.")] = False,
    param: ParamOption = None,
    config: ConfigOption = None,
    seed: SeedOption = 0,
    overwrite: Annotated[bool, typer.Option("--overwrite", help="Replace a map file that is there.")] = False,
    append: Annotated[
        bool, typer.Option("--append", help="Add a session to a map file that is there; loops join it.")
    ] = False,
    localize: Annotated[
        bool, typer.Option("--localize", help="Localise in a map file that is there; as Mem/IncrementalMemory=false.")
    ] = False,
    serve: Annotated[bool, typer.Option("--serve", help="Watch it in the browser.")] = False,
    speed: Annotated[
        float, typer.Option(min=0, max=100, help="With --serve: times real time; 0 is as fast as possible.")
    ] = 0.0,
    host: HostOption = "127.0.0.1",
    port: PortOption = PORT,
    token: TokenOption = None,
    no_token: NoTokenOption = False,
    name: NameOption = None,
) -> None:
    """Map a sequence into a file, or localise in one, with a summary at the end."""
    values = parameters(config, param)
    if localize:
        values["Mem/IncrementalMemory"] = False
    check_target(db, values, overwrite=overwrite, append=append)

    def show(summary: Mapping[str, Any]) -> None:
        show_summary(summary, db, as_json=json)

    if serve:
        settings = settings_of([db], [], host, port, token, no_token, name)
        run_live(
            settings,
            source,
            db,
            values,
            seed=seed,
            speed=speed,
            overwrite=overwrite,
            append=append,
            note="",
            on_summary=show,
        )
        return
    from server.cli.plain_run import plain_run

    show(plain_run(source, db, values, seed=seed, overwrite=overwrite, append=append))


def show_summary(summary: Mapping[str, Any], path: Path, *, as_json: bool) -> None:
    """Print what came of a run."""
    if as_json:
        typer.echo(json_format.dumps(dict(summary)))
        return
    from rich.console import Console

    from server.cli.summary_table import summary_table

    Console().print(summary_table(summary, path))
