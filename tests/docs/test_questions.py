"""The questions of readers are answered on the pages that the table names, and commits that pages follow exist."""

import re
import subprocess
import tomllib
from functools import cache
from pathlib import Path

import pytest
from generated_pages import key_pages, pages
from published import published_pages

ROOT = Path(__file__).parents[2]
QUESTIONS = tomllib.loads(Path(__file__).with_name("questions.toml").read_text("utf-8"))["question"]


@cache
def generated():
    """Pages that the build writes, but for those of examples, which are computed."""
    return {**pages(ROOT, []), **key_pages()}


def source(page):
    """The text of a page of the site, as it is written."""
    if not page.startswith("generated/"):
        return (ROOT / f"docs/{page}.md").read_text("utf-8")
    name = page.removeprefix("generated/") + ".md"
    return published_pages()[name] if name.startswith("published/") else generated()[name]


def questions(computed):
    is_computed = [any("published" in page for page in question["found"]) for question in QUESTIONS]
    return [question for question, one in zip(QUESTIONS, is_computed) if one == computed]


@pytest.mark.parametrize("question", questions(False), ids=lambda question: question["text"])
def test_question_is_answered_on_its_pages(question):
    answered(question)


@pytest.mark.campaign
@pytest.mark.parametrize("question", questions(True), ids=lambda question: question["text"])
def test_question_is_answered_on_pages_of_examples(question):
    answered(question)


def answered(question):
    assert question["answer"] and 1 <= len(question["pages"]) <= 3
    for page, texts in question["found"].items():
        text = source(page)
        assert [each for each in texts if each not in text] == []


def test_the_twelve_and_ten_questions_are_kept():
    assert len(QUESTIONS) >= 22 and len({question["text"] for question in QUESTIONS}) == len(QUESTIONS)


def test_commits_that_pages_follow_exist():
    if not (ROOT / ".git").exists():
        pytest.skip("no history")
    named = {
        commit
        for page in (ROOT / "docs").glob("adding-*.md")
        for commit in re.findall(r"`([0-9a-f]{8})`", page.read_text("utf-8"))
    }
    assert len(named) >= 4
    known = subprocess.run(["git", "-C", ROOT, "rev-list", "HEAD"], capture_output=True, text=True, check=True).stdout
    if len(known.split()) < 500:
        pytest.skip("a part of the history")
    assert [commit for commit in sorted(named) if not any(line.startswith(commit) for line in known.split())] == []
