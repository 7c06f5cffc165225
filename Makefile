# Thin: scripts and CMake presets do the work.
.PHONY: demo run test quick bench format
demo:
	script/demo
run:
	script/setup run
	script/build release intaglio
	build/release/intaglio run
test:
	script/test
quick:
	INTAGLIO_QUICK=1 script/test
bench:
	script/build release
	for bench in build/release/bench/bench_*; do $$bench; done
format:
	git ls-files '*.h' '*.cpp' | xargs clang-format-14 -i
	tools/wrap_markdown.py *.md docs/*.md
