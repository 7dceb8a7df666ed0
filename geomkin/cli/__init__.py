"""The command `geomkin`: `write.py` has the commands that write files, `show.py` those that print or show something.

Both take their recipes, and report on each, by `recipes.py`.
"""

from __future__ import annotations

import click

from . import show, write

EXIT_STATUS = """\b
Exit status:
  0  done; checks of a design may have failed
  1  a recipe was refused or could not be made (the other recipes were made), or a file is not as designed
  2  the command was called wrongly; nothing was done
  3  with --strict: all recipes were made, and a check failed that its recipe does not expect to fail"""


@click.group(context_settings={"help_option_names": ["-h", "--help"]}, invoke_without_command=True, epilog=EXIT_STATUS)
@click.version_option(package_name="geomkin")
@click.pass_context
def cli(context: click.Context) -> None:
    """Turn text recipes into planar mechanisms: linkages, cams and gears.

    Start with `geomkin list` and `geomkin new KIND > my.toml`; then `geomkin run my.toml` writes drawings to cut,
    solids to print, the motion as CSV, and an animated page.
    """
    if context.invoked_subcommand is None:
        click.echo(context.get_help())


for command in (
    write.run, write.verify_command, write.new_kind, write.sweep_command, write.optimise_command, write.chart_command,
    show.check_command, show.columns_command, show.examples_command, show.explain, show.import_command,
    show.list_command, show.new, show.schema_command, show.studio,
):  # fmt: skip
    cli.add_command(command)
