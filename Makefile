# Thin: scripts and CMake presets do the work.
.PHONY: demo test quick format
demo:
	script/demo
test:
	script/test
quick:
	INTAGLIO_QUICK=1 script/test
format:
	git ls-files '*.h' '*.cpp' | xargs clang-format-14 -i
