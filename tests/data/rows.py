"""JSON with an array of numbers on a line, for the scripts of this folder."""

import json
import re


def written(value):
    text = json.dumps(value, indent=1)
    return re.sub(r"\[\s+([^\[\]{}]*?)\s+\]", lambda found: f"[{' '.join(found[1].split())}]", text)
