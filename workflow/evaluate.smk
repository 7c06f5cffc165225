# Evaluates every texture of a folder, on this machine or on a cluster; a job is one texture. docs/evaluate.md, "Several textures".
#
#   snakemake -s workflow/evaluate.smk --cores 2 --config textures=my_textures results=out/evaluations
#
# Settings (config): textures, results; optional: intaglio (the command), options (more of its options, such as --quick), and memory_mb
# and minutes of one job. Every image, recipe and folder in `textures` is a texture. Results that are done are kept.
from pathlib import Path

TEXTURES = Path(config.get("textures", "textures"))
RESULTS = config.get("results", "out/evaluations")
INTAGLIO = config.get("intaglio", "build/release/intaglio")
SUFFIXES = {".png", ".jpg", ".jpeg", ".tga", ".exr", ".toml"}

SOURCES = {}
for path in sorted(TEXTURES.iterdir()) if TEXTURES.is_dir() else []:
    if not path.is_dir() and path.suffix.lower() not in SUFFIXES:
        continue
    name = path.name if path.is_dir() else path.stem
    if name in SOURCES:
        raise WorkflowError(f"{path} would have the same result as {SOURCES[name]}: give them different names")
    SOURCES[name] = str(path)
if not SOURCES:
    raise WorkflowError(f"{TEXTURES} holds no texture: give a folder of images, or of folders of images")


rule all:
    input:
        RESULTS + "/summary.csv",


rule evaluate:
    input:
        lambda wildcards: SOURCES[wildcards.name],
    output:
        page=RESULTS + "/{name}.html",
        numbers=RESULTS + "/{name}.json",
    params:
        options=config.get("options", ""),
    threads: 1
    resources:
        mem_mb=int(config.get("memory_mb", 4000)),
        runtime=int(config.get("minutes", 30)),
    shell:
        "{INTAGLIO} -q evaluate {input:q} {params.options} --html {output.page:q} --json {output.numbers:q}"


# The command makes the table of the results that are there.
rule summary:
    input:
        expand(RESULTS + "/{name}.json", name=SOURCES),
    output:
        RESULTS + "/summary.csv",
    params:
        textures=list(SOURCES.values()),
    shell:
        "{INTAGLIO} -q evaluate {params.textures:q} -o {RESULTS:q}"
