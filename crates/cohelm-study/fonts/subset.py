#!/usr/bin/env python3
"""Cuts the faces down to what figures and reports write. See README.md.

    pip install fonttools==4.68.0 brotli==1.2.1
    python subset.py FOLDER_OF_INTER FOLDER_OF_SOURCE_SERIF_4
"""
import sys
from pathlib import Path
from fontTools import subset

LATIN = [*range(0x20, 0x7F), *range(0xA0, 0x180), 0x1E9E, 0x2C6, 0x2DC]
GREEK = range(0x391, 0x3CA)
PUNCTUATION = [*range(0x2010, 0x2015), 0x2018, 0x2019, 0x201A, 0x201C, 0x201D, 0x201E, 0x2020, 0x2021, 0x2022, 0x2026,
               0x2030, 0x2032, 0x2033, 0x2009, 0x200A, 0x202F, 0x20AC]
RAISED_AND_LOWERED = [0x2070, *range(0x2074, 0x207A), 0x207B, *range(0x2080, 0x2084)]
SIGNS = [*range(0x2190, 0x2194), 0x2202, 0x2206, 0x2211, 0x2212, 0x221A, 0x221E, 0x2248, 0x2260, 0x2264, 0x2265, 0x25A0, 0x25CB,
         0x25CF, 0x2713, 0x2717]


def cut(source, target, features):
    options = subset.Options(layout_features=features, hinting=False, flavor="woff2" if target.endswith("woff2") else None)
    options.name_IDs = [0, 1, 2, 3, 4, 5, 6, 13, 14, 16, 17]
    font = subset.load_font(str(source), options)
    subsetter = subset.Subsetter(options)
    subsetter.populate(unicodes=[*LATIN, *GREEK, *PUNCTUATION, *RAISED_AND_LOWERED, *SIGNS])
    subsetter.subset(font)
    if "Cohelm" in target:
        rename(font, target.split(".")[0])
    subset.save_font(font, target, options)


def rename(font, name):
    """The licence reserves the name "Source" for unmodified fonts, and a cut-down font is modified."""
    family, style = name.replace("CohelmSerif", "Cohelm Serif").split("-")
    texts = {1: family, 2: style, 3: name, 4: f"{family} {style}", 6: name, 16: family, 17: style}
    for record in font["name"].names:
        if record.nameID in texts:
            record.string = texts[record.nameID]


inter, serif = Path(sys.argv[1]), Path(sys.argv[2])
for source, name in [
    (inter / "400Regular/Inter_400Regular.ttf", "Inter-Regular"),
    (inter / "600SemiBold/Inter_600SemiBold.ttf", "Inter-SemiBold"),
    (serif / "400Regular/SourceSerif4_400Regular.ttf", "CohelmSerif-Regular"),
    (serif / "400Regular_Italic/SourceSerif4_400Regular_Italic.ttf", "CohelmSerif-Italic"),
    (serif / "600SemiBold/SourceSerif4_600SemiBold.ttf", "CohelmSerif-SemiBold"),
]:
    cut(source, f"{name}.woff2", ["kern", "lnum", "tnum"])
    if name.startswith("Inter"):
        cut(source, f"{name}.ttf", ["kern"])
