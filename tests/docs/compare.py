# SPDX-License-Identifier: Apache-2.0
"""Whether what was printed is what the page says."""

import json
import re

NUMBER = re.compile(r"[-+]?\d+(?:\.\d+)?(?:[eE][-+]?\d+)?")


def alike(said, printed):
    """The same words, and numbers within 2 % or two of the last digit that the page gives."""
    words_said, words_printed = NUMBER.split(said), NUMBER.split(printed)
    if [w.split() for w in words_said] != [w.split() for w in words_printed]:
        return False
    for a, b in zip(NUMBER.findall(said), NUMBER.findall(printed)):
        digits = len(a.split(".")[1]) if "." in a and "e" not in a.lower() else 0
        if abs(float(a) - float(b)) > max(0.02 * abs(float(a)), 2.0 * 10.0**-digits if "." in a else 0.0):
            return False
    return True


def part_of(said, answered):
    """What the page shows of an answer is in it: keys and words are the same, numbers those of another moment."""
    if isinstance(said, dict):
        return isinstance(answered, dict) and all(key in answered and part_of(value, answered[key])
                                                  for key, value in said.items())
    if isinstance(said, list):
        return isinstance(answered, list) and len(said) <= len(answered) and all(map(part_of, said, answered))
    if isinstance(said, (int, float)) and not isinstance(said, bool):
        return isinstance(answered, (int, float)) and not isinstance(answered, bool)
    return type(said) is type(answered) and said == answered


def json_values(lines):
    """The JSON values that stand one after the other in the lines; None where something else does."""
    text, values, decoder = "\n".join(lines).strip(), [], json.JSONDecoder()
    while text:
        try:
            value, end = decoder.raw_decode(text)
        except ValueError:
            return None
        values.append(value)
        text = text[end:].strip()
    return values


def missing_answer(lines, printed):
    """The first answer of the page that was not given; None where all were."""
    said, answered = json_values(lines), json_values(printed)
    if said is None or answered is None:
        return "JSON, on the page and in the answer"
    if len(said) != len(answered):
        return f"{len(said)} answers"
    return next((json.dumps(a) for a, b in zip(said, answered) if not part_of(a, b)), None)


def missing_line(kind, lines, printed):
    """The first of the lines that was not printed; None where all were."""
    if kind == "answer":
        return missing_answer(lines, printed)
    at = 0
    for line in lines:
        if kind == "prints":
            found = next((i for i, p in enumerate(printed) if p.startswith(line)), None)
        else:
            found = next((i for i in range(at, len(printed)) if alike(line, printed[i])), None)
            at = at if found is None else found + 1
        if found is None:
            return line
    return None
