# Thin: scripts and CMake presets do the work.
.PHONY: demo test quick bench format
demo:
	script/demo
test:
	script/test
quick:
	INTAGLIO_QUICK=1 script/test
bench:
	script/build release
	for bench in build/release/bench/bench_*; do $$bench; done
format:
	git ls-files '*.h' '*.cpp' | xargs clang-format-14 -i
