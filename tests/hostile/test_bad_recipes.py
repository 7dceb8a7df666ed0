"""Texts that are no recipe: one clear line for each problem, nothing written, never a traceback."""

import subprocess

import pytest

WHOLE = "(whole file)"


def test_invalid_recipe_gives_one_line_error(run, refused):
    for content, key, word in [
        (b"", "kind", ""),
        (bytes(range(256)), WHOLE, "UTF-8"),
        ('kind = "four-bar"'.encode("utf-16"), WHOLE, "UTF-8"),
        (b"\0" * 1000, WHOLE, ""),
        (b"kind = four-bar", "kind", ""),
        (b'kind = "four-bar"\nkind = "four-bar"', WHOLE, ""),
        (b'kind = "\\ud800"', WHOLE, ""),
        (b"#" * 1_000_000, WHOLE, ""),
        (b"a = " + b"[" * 10_000 + b"]" * 10_000, WHOLE, ""),
        (b"a = " + b"{a = " * 10_000 + b"1" + b"}" * 10_000, WHOLE, ""),
        (b"kind = " + b"9" * 5000, WHOLE, ""),
        (b'kind = "for-bar"', "kind", ""),
        (b'kind = ["four-bar"]', "kind", ""),
        (b'kind = "' + b"x" * 5000 + b'"', "kind", ""),
        (b'kind = "four-bar"', "linkage", ""),
    ]:
        refused(run(content), key, word)


LONG = {
    "bare parts": "kind." + ".".join(["a"] * 100_000) + " = 1",
    "quoted parts": "kind." + ".".join(['"a"'] * 60_000) + " = 1",
    "spaced parts": "kind." + ".".join(['"a b"'] * 40_000) + " = 1",
    "dotted parts": "[" + ". ".join(["'a.b'"] * 40_000) + "]",
    "escapes": 'a = "' + '\\"' * 200_000 + '"',
    "list": 'a = ["' + '", "'.join(["b"] * 100_000) + '"]',
    "inline parts": "kind = {" + ".".join(["a"] * 100_000) + " = 1}",
    "header": "[" + ".".join(["a"] * 250_000) + "]",
    "one word": 'kind = "' + "x" * 2_000_000 + '"',
    "remark": "# " + "word. " * 300_000,
    "many keys": "[files]\n" + "".join(f"k{i} = 1\n" for i in range(20_000)),
}


@pytest.mark.campaign
def test_long_texts_are_answered_at_once(command, here):
    # A reader's time may grow with the square of what stands in a line: 200 kB would keep it for minutes.
    for name, content in LONG.items():
        (here / f"{name}.toml").write_text(content)
    try:
        done = command("run", ".", timeout=30)
    except subprocess.TimeoutExpired:
        pytest.fail("still reading after 30 s")
    assert done.returncode == 1 and {line.split(".toml: ")[0] for line in done.stderr.splitlines()} == set(LONG)


def test_line_ends_and_byte_order_mark_of_other_systems_are_read(run, recipe):
    text = recipe("spur-gear", {"files.write": '["csv"]'})
    assert run(b"\xef\xbb\xbf" + text.replace("\n", "\r\n").encode()).exit_code == 0


def test_an_unprintable_or_endless_key_cannot_spoil_the_terminal(run, refused, recipe):
    for key in ['"a\\nb"', '"\\u001b[31m"', "k" * 5000]:
        result = run(recipe("four-bar", {f"stock.{key}": "1"}))
        refused(result, "stock", "unknown key")
        assert len(result.stderr) < 1000
