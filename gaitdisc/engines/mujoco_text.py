"""Insertions into the text of an MJCF file: attributes of the user's own elements, and a tendon at its end."""

from __future__ import annotations

import re
from collections.abc import Mapping
from xml.parsers import expat

import numpy as np

from gaitdisc.engines.motion import ByHand

# a free joint with numbers, none of which a default class gives
AS_FREE = '<joint type="free" armature="0" stiffness="0" damping="0" frictionloss="0"'
MORE_OF = {"viscous_damping": "damping", "coulomb_friction": "frictionloss"}  # effect: attribute of a joint


def with_range(text: str, called: str, low: float, high: float, of: str) -> str | None:
    """Text with the range of an actuator's control, or of its force; None where the file does not name it."""
    tag, values = _find(text, "actuator", called), {f"{of}limited": "true", f"{of}range": f"{low!r} {high!r}"}
    return None if tag is None else _with_attributes(text, tag, values)


def with_value(text: str, name: str, value: float, kind: str, called: str, shape: Mapping | None = None) -> str | None:
    """Text with a number of a joint, body or option changed; None where the file does not say it.

    name: `<part>_mass`, `_stiffness`, `_damping`, `_frictionloss` (of a joint or tendon), `_gear`, `_force`, or gravity
    kind, called: tag and name of the element in the file
    shape: attributes of a body's inertia, as MuJoCo has computed it from shapes that have no mass of their own
    """
    if name == "gravity":
        tags = [tag for tag in _tags(text) if tag[0] == "option"]
        given = _attribute(text, tags[0], "gravity") if tags else None
        vector = np.array([float(each) for each in given.split()]) if given else np.array([0.0, 0.0, -9.81])
        words = " ".join(repr(float(each)) for each in vector * (value / np.linalg.norm(vector)))
        end = f'  <option gravity="{words}"/>\n'
        return _with_attributes(text, tags[0], {"gravity": words}) if tags else _before_end(text, end)
    tag, word = _find(text, kind, called), name.rpartition("_")[2]
    if tag is None:
        return None
    if word == "mass":
        words = (f'{word}="{" ".join(map(repr, each.tolist()))}"' for word, each in (shape or {}).items())
        inertial = f'<inertial mass="{value!r}" {" ".join(words)}/>' if shape else ""
        return _with_mass(text, tag, value, inertial)
    if tag[0] == "freejoint" and text[tag[2] - 2] == "/":
        text = text[: tag[1]] + AS_FREE + text[tag[1] + len("<freejoint") :]
        tag = next(other for other in _tags(text) if other[1] == tag[1])
    rest = (_attribute(text, tag, "gear") or "1").split()[1:] if word == "gear" else []
    return _with_attributes(text, tag, {word: " ".join([repr(value), *rest])})


def with_effect(text: str, effect: ByHand, joint: str, passive: Mapping[str, float]) -> str | None:
    """Text with an effect on a joint; None where MuJoCo has no form of it.

    passive: stiffness, damping and frictionloss that the joint has, which may come from a default class
    """
    tag, name = _find(text, "joint", joint), effect.term.name
    if not joint or tag is None:
        return None
    at_one, at_speed_one = -effect.at(1.0, 0.0), -effect.at(0.0, 1.0)
    if name == "linear_stiffness":
        return _with_spring(text, tag, at_one, passive["stiffness"])
    attribute, words = MORE_OF.get(name, ""), ""
    first, *rest = (_attribute(text, tag, attribute or "damping") or repr(passive[attribute or "damping"])).split()
    if attribute:
        words = " ".join([repr(float(first) + at_speed_one), *rest])
    elif name == "cubic_stiffness" and _attribute(text, tag, "stiffness") is None:
        attribute, words = "stiffness", f"0 0 {at_one!r}"
    elif name == "quadratic_drag" and not rest:
        attribute, words = "damping", f"{first} {at_speed_one!r}"
    if attribute:
        return _with_attributes(text, tag, {attribute: words})
    low, stiffness, high = effect.slack if name == "one_sided_spring" else (0.0, 0.0, 0.0)  # slack in between
    if not stiffness > 0:
        return None
    spring = f'name="one_sided_spring_{joint}" stiffness="{stiffness!r}" springlength="{low!r} {high!r}"'
    inside = f'    <fixed {spring}>\n      <joint joint="{joint}" coef="1"/>\n    </fixed>\n'
    return _before_end(text, f"  <tendon>\n{inside}  </tendon>\n")


def _with_mass(text: str, body: _Tag, value: float, inertial: str) -> str | None:
    """Another mass of a body's own inertia, or of its one shape with a mass; else an inertia of its own."""
    inner = [part for part in _tags(text) if part[3] == body[1] and part[0] in ("inertial", "geom")]
    massive = [part for part in inner if part[0] == "inertial"] or inner
    if len(massive) != 1 or _attribute(text, massive[0], "mass") is None:
        return f"{text[: body[2]]}{inertial}{text[body[2] :]}" if inertial and len(massive) == len(inner) else None
    tag, values = massive[0], {"mass": repr(value)}
    for name in ("diaginertia", "fullinertia") if tag[0] == "inertial" else ():
        given = _attribute(text, tag, name)
        if given:  # of the same shape: the inertia goes with the mass
            share = value / float(_attribute(text, tag, "mass") or 1.0)
            values[name] = " ".join(repr(float(word) * share) for word in given.split())
    return _with_attributes(text, tag, values)


def _with_spring(text: str, tag: _Tag, stiffness: float, before: float) -> str | None:
    """A linear spring about zero, together with the one that the joint has."""
    springs = (_attribute(text, tag, "stiffness") or repr(before)).split()
    rest = float(_attribute(text, tag, "springref") or 0.0)
    if len(springs) > 1:
        return None
    both = float(springs[0]) + stiffness
    turned = {"springref": repr(float(springs[0]) * rest / both)} if rest and both else {}
    return _with_attributes(text, tag, {**turned, "stiffness": repr(both)})


_TAG = re.compile(r"""<(?:[^>"']|"[^"]*"|'[^']*')*>""")
_Tag = tuple[str, int, int, int]  # name, where it begins and ends, where its parent begins


def _tags(text: str) -> list[_Tag]:
    """Every opening tag of the text, by characters."""
    whole = text.encode("utf-8")
    tags, above = list[_Tag](), list[int]()
    parser = expat.ParserCreate("utf-8")

    def opened(name: str, _: object) -> None:
        begin = len(whole[: parser.CurrentByteIndex].decode("utf-8"))
        tag = _TAG.match(text, begin)
        assert tag is not None
        tags.append((name, begin, tag.end(), above[-1] if above else -1))
        above.append(begin)

    parser.StartElementHandler = opened
    parser.EndElementHandler = lambda _: above.pop()
    parser.Parse(whole, True)
    return tags


def _find(text: str, kind: str, called: str) -> _Tag | None:
    """The one tag of an element, None where there is none or more; those of actuators and tendons have many names."""
    group, tags = kind in ("actuator", "tendon"), _tags(text)
    alike = (t for t in tags if (text[t[3] :].startswith(f"<{kind}") if group else t[0] in (kind, f"free{kind}")))
    named = [tag for tag in alike if _attribute(text, tag, "name") == called]
    return named[0] if len(named) == 1 else None


def _attribute(text: str, tag: _Tag, name: str) -> str | None:
    match = re.search(rf"\s{name}\s*=\s*(\"[^\"]*\"|'[^']*')", text[tag[1] : tag[2]])
    return match[1][1:-1] if match else None


def _with_attributes(text: str, tag: _Tag, values: Mapping[str, str]) -> str:
    element = text[tag[1] : tag[2]]
    for name, value in values.items():
        if _attribute(text, tag, name) is not None:
            known = rf"(\s{name}\s*=\s*)(\"[^\"]*\"|'[^']*')"
            element = re.sub(known, rf'\g<1>"{value}"', element, count=1)
        else:
            element = re.sub(r"\s*(/?>)$", rf' {name}="{value}"\g<1>', element)
    return text[: tag[1]] + element + text[tag[2] :]


def _before_end(text: str, more: str) -> str:
    at = text.rindex("</mujoco>")
    return text[:at] + more + text[at:]
