"""Scripts and styles of a page without idle spaces: shorter, and never another program."""

import pytest

from geomkin.page import page
from geomkin.page.page import _script, _tight, tight_style

LIBRARY = "var uPlot = 1;"
ONE = """
// What it is.
import { two } from "./two.js";

/* Another remark. */
export const one = 1;
const list = [
  one,
  two,
];
export const add = (a) => {
  const twice = 2 * a;
  const text = "a + b; (c) => d";
  if (twice > 2) {
    return `${ twice } or ${ a } : ${ one }`;
  }
  return a - -twice;
};
"""
TWO = """
export const two = [1,
  2];
const three = 3;
let four = 4;
const five = (() => 5)();
const six = 6; const seven = 7;
const eight = 8;
"""
# Run by hand once: it gives what the scripts above give.
TOLD = (
    "var uPlot = 1;\n"
    "const two=[1,2];const three=3;let four=4;const five=(()=>5)(),six=6;const seven=7;"
    "const eight=8,one=1,list=[one,two,];const add=a=>{"
    'const twice=2*a,text="a + b; (c) => d";if(twice>2){'
    "return `${ twice } or ${ a } : ${ one }`}return a - -twice};start(one);\n"
)


def test_scripts_are_one_module_whose_declarations_stay_whole(monkeypatch):
    held = {"library.js": LIBRARY, "two.js": TWO.strip(), "one.js": ONE.strip()}
    monkeypatch.setattr(page, "web_file", held.get)
    assert _script(tuple(held), "start(one);") == TOLD


@pytest.mark.parametrize(
    ("line", "told"),
    [
        ("a = b ? c : d", "a=b?c:d"),
        ("a = b + c - d", "a=b+c-d"),
        ("a - -b", "a - -b"),
        ("a + +b", "a + +b"),
        ("a + b++ + c", "a+b++ +c"),
        ("i++; j -= 2; k += 3", "i++;j-=2;k+=3"),
        ('say("a + b", c + d)', 'say("a + b",c+d)'),
        ("say(`a + b`, c + d)", "say(`a + b`,c+d)"),
        ("say(`a ${b + `c + d`}`)", "say(`a ${b + `c + d`}`)"),
        ("a.replace(/x = [/ ]+/g, b / c)", "a.replace(/x = [/ ]+/g,b/c)"),
        ("(a) => b", "a=>b"),
        ("(a, b) => c", "(a,b)=>c"),
        ("f(a) => b", "f(a)=>b"),
        ("return (a) => b", "return(a)=>b"),
        ("const { a, b } = c", "const{a,b}=c"),
        ("if (a && !b || c) {", "if(a&&!b||c){"),
        ("typeof a in b", "typeof a in b"),
        ("new Map([[a, b]])", "new Map([[a,b]])"),
    ],
)
def test_a_line_is_tight_and_texts_and_patterns_in_it_are_as_they_were(line, told):
    assert _tight(line) == told


def test_a_style_is_tight_and_keeps_the_spaces_that_tell():
    style = ".a .b > .c { margin: 0 1px;\n  color: red; } /* a > b\n; */\n@media (width < 3px) { p { top: 1px } }\n"
    assert tight_style(style) == ".a .b>.c{margin:0 1px;color:red}@media (width < 3px){p{top:1px}}"
