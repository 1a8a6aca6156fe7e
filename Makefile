# frictionCG: contact with Coulomb friction for FreeFEM.  `make help` lists the targets.

SHELL     := /bin/bash
CXX       ?= g++
BUILD     := build
# As FreeFEM and its plugins are built; sanitize and mutants keep the assertions of Eigen.
CXXFLAGS  ?= -O3 -DNDEBUG
# GCC 14 takes Eigen's vectors of at most two entries for overrun, where they are not.
WARN      := -Wall -Wextra -Wshadow -Wno-array-bounds
ifdef CI
WARN      += -Werror
endif
INCLUDE   := -Iplugin/core -Iplugin -DEIGEN_USE_BLAS -DEIGEN_DONT_PARALLELIZE -isystem /usr/include/eigen3 -isystem /usr/include/suitesparse
# GCC collects its garbage from 1 GB on: sooner, that takes a quarter of its time. clang has none.
HEAP      := $(if $(findstring clang,$(CXX)),,--param ggc-min-heapsize=1000000)
# clang's own OpenMP is another library than CHOLMOD's: by clang multigrid has one thread.
OPENMP    := $(if $(findstring clang,$(CXX)),,-fopenmp)
FLAGS      = -std=c++17 -fPIC $(OPENMP) $(HEAP) $(CXXFLAGS) $(WARN) $(INCLUDE)
LIBS      := -lcholmod -lblas -lgomp
PACKAGES  := libeigen3-dev libsuitesparse-dev libopenblas0-pthread libopenblas-dev libgtest-dev \
             gnuplot-nox ghostscript g++

# FreeFEM: Debian's packages, or the newest one that FreeFEM's own installer has put under FREEFEM.
ifdef FREEFEM
FF_PREFIX  := $(abspath $(FREEFEM))
FF_HOME    := $(shell ls -d $(FF_PREFIX)/lib/ff++/*/include/ff++.hpp 2>/dev/null | sort -V | tail -n 1)
FF_HOME    := $(FF_HOME:/include/ff++.hpp=)
FF_INCLUDE := $(FF_HOME)/include
FF_PLUGINS := $(FF_HOME)/lib
FF_IDP     := $(FF_HOME)/idp
FF_PROGRAM := $(firstword $(wildcard $(FF_PREFIX)/bin/FreeFem++-nw $(FF_PREFIX)/bin/FreeFem++))
ifeq ($(and $(FF_HOME),$(FF_PROGRAM)),)
$(error FREEFEM=$(FREEFEM) holds no FreeFEM: lib/ff++/VERSION/include/ff++.hpp or bin/FreeFem++ is missing)
endif
else
FF_PREFIX  := /usr
FF_INCLUDE := /usr/include/freefem++
FF_PLUGINS := /usr/lib/freefem++
FF_IDP     := /usr/include/freefem++/idp
FF_PROGRAM := FreeFem++-nw
PACKAGES   += freefem++ libfreefem++-dev
endif
# FreeFEM's own operator new confuses this one warning.
FF_FLAGS   := -isystem $(FF_INCLUDE) -Wno-mismatched-new-delete
PREFIX     ?= $(FF_PREFIX)

# An object is made of several sources of a folder, a+b.o of a.cpp and b.cpp: what they have in common of Eigen and FreeFEM is
# compiled once. TOGETHER=1 makes one of each.
TOGETHER  ?= 4
BEYOND    := $(shell echo $$(($(TOGETHER) + 1)))
NONE      :=
SPACE     := $(NONE) $(NONE)
joined     = $(if $1,$(subst $(SPACE),+,$(basename $(notdir $(wordlist 1,$(TOGETHER),$1)))) $(call joined,$(wordlist $(BEYOND),$(words $1),$1)))
# $(call objects,folder of the objects,sources of one folder)
objects    = $(patsubst %,$1%.o,$(call joined,$(sort $2)))
# $(call sources,folder/a+b): and back
sources    = $(foreach name,$(subst +, ,$(notdir $1)),$(dir $1)$(name).cpp)
# The compiler reads the last of them, and the others before it.
compiled   = $(patsubst %,-include %,$(filter-out $(lastword $1),$1)) -c $(lastword $1)

CORE      := $(wildcard plugin/core/*.cpp plugin/core/*/*.cpp plugin/core/*/*/*.cpp)
OBJECTS   := $(foreach folder,$(sort $(dir $(CORE))),$(call objects,$(folder:plugin/%=$(BUILD)/%),$(wildcard $(folder)*.cpp)))
CORE_H    := $(wildcard plugin/core/*.h plugin/core/*/*.h plugin/core/*/*/*.h)
HEADERS   := $(CORE_H) $(wildcard plugin/freefem/*.h)
ADAPTER   := $(wildcard plugin/freefem/*.cpp)
ADAPTERS  := $(call objects,$(BUILD)/freefem/,$(ADAPTER))
UNIT      := $(filter-out tests/unit/standalone/%,$(wildcard tests/unit/*.cpp tests/unit/*/*.cpp))
TESTS     := $(foreach folder,$(sort $(dir $(UNIT))),$(call objects,$(folder:tests/%=$(BUILD)/%),$(wildcard $(folder)*.cpp)))
IDP       := $(wildcard edp/*.idp)
SCRIPTS   := $(wildcard tests/edp/*.edp)
EXAMPLES  := $(filter-out %-mpi.edp,$(wildcard examples/*.edp))
# Under several processes: tests/run leaves them out where `make mpi` has not been
WITH_MPI   = $(wildcard $(BUILD)/frictionCG-mpi.so)
SHARED    := $(wildcard tests/mpi/*.edp examples/*-mpi.edp) tests/mpi/scarce tests/mpi/limited
PAGES     := README.md $(wildcard edp/doc/*.md)
BENCHES   := $(wildcard tests/bench/*.cpp)
BENCH_PLUGINS = $(BENCHES:tests/bench/%.cpp=$(BUILD)/%.so)
OWN       := $(CORE) $(ADAPTER) $(HEADERS) $(wildcard plugin/*.cpp plugin/mpi/*.cpp plugin/mpi/*.h tests/unit/*.cpp tests/unit/*.h \
               tests/unit/*/*.cpp tests/unit/*/*.h tests/bench/*.cpp tests/bench/*.h tests/scarce/*.cpp)

# Debian's freefem++.pref names a folder that does not exist; the first two make up for it.
export FF_LOADPATH    := $(CURDIR)/$(BUILD);$(FF_PLUGINS)
export FF_INCLUDEPATH := $(CURDIR)/$(BUILD);$(FF_IDP)
export FF_PROGRAM
export FF_PROGRAM_MPI := $(if $(FREEFEM),$(FF_PREFIX)/bin/)FreeFem++-mpi
RUN       := $(FF_PROGRAM) -nw -v 0

.PHONY: all core mpi help setup setup-mpi demo check unit scripts shared examples pages bench scaling report format lint \
        sanitize coverage install fresh mutants clean

all: $(BUILD)/frictionCG.so $(IDP:edp/%=$(BUILD)/%) ## build the plugin

help: ## list the targets
	@sed -n 's/^\([a-z]*\):.*## \(.*\)/  make \1\t\2/p' Makefile | expand -t 18

setup: ## install what is missing from Debian's packages
	@missing=; for p in $(PACKAGES); do dpkg -s $$p >/dev/null 2>&1 || missing="$$missing $$p"; done; \
	if [ -n "$$missing" ]; then \
	  echo "installing:$$missing"; \
	  sudo=; [ $$(id -u) = 0 ] || sudo=sudo; \
	  $$sudo apt-get update -qq && \
	  $$sudo env DEBIAN_FRONTEND=noninteractive \
	    apt-get install -y -qq --no-install-recommends $$missing >/dev/null || { echo "cannot install:$$missing"; exit 1; }; \
	fi

# The plugin calls what it defines, and not what FreeFEM has under the same name: see freefem/load.h.
OWN_NEW   := -Wl,-Bsymbolic-functions

# The compiler writes what each object includes beside it, so that a header rebuilds what reads it.
DEPENDS   := -MMD -MP

# What nearly every file reads, Eigen above all, is compiled once. `PRECOMPILED=` does without: no file needs it.
PRECOMPILED := precompiled.h
PRELUDE     := plugin/core/precompiled.h plugin/core/types.h
CORE_PCH     = $(PRECOMPILED:%=$(BUILD)/core/%)
UNIT_PCH     = $(PRECOMPILED:%=$(BUILD)/unit/%)
# where ccache preprocesses, it reads the compiled one too
READ        := -fpch-preprocess -include

$(BUILD)/core/precompiled.h.gch: $(PRELUDE) Makefile
	@mkdir -p $(@D) && cp $< $(@D)
	$(CXX) $(FLAGS) $(CORE_FLAGS) -x c++-header $< -o $@

$(BUILD)/unit/precompiled.h.gch: tests/unit/precompiled.h $(PRELUDE) Makefile
	@mkdir -p $(@D) && cp $< $(@D)
	$(CXX) $(FLAGS) -O1 -Itests -x c++-header $< -o $@

.SECONDEXPANSION:

$(BUILD)/core/%.o: $$(call sources,plugin/core/%) Makefile $(CORE_PCH:=.gch)
	@mkdir -p $(@D)
	$(CXX) $(FLAGS) $(DEPENDS) $(CORE_FLAGS) $(addprefix $(READ) ,$(CORE_PCH)) $(call compiled,$(call sources,plugin/core/$*)) -o $@

ADAPT = $(CXX) $(FLAGS) $(DEPENDS) $(FF_FLAGS) $(addprefix $(READ) ,$(CORE_PCH)) $(call compiled,$1) -o $@

$(BUILD)/freefem/%.o: $$(call sources,plugin/freefem/%) Makefile $(CORE_PCH:=.gch)
	@mkdir -p $(@D)
	$(call ADAPT,$(call sources,plugin/freefem/$*))

$(BUILD)/frictionCG.o: plugin/frictionCG.cpp Makefile $(CORE_PCH:=.gch)
	$(call ADAPT,$<)

$(BUILD)/frictionCG.so: $(BUILD)/frictionCG.o $(ADAPTERS) $(OBJECTS)
	$(CXX) -shared $(OWN_NEW) $(LDFLAGS) $^ -o $@ $(LIBS)

# The plugin of several processes: what it needs beyond the sequential one is asked for here alone.
MPI_PACKAGES := petsc-dev libopenmpi-dev openmpi-bin pkg-config
MPI_SOURCES  := $(wildcard plugin/mpi/*.cpp)
# not in a folder called mpi: FreeFem++-mpi would look for plugins nowhere else
MPI_PLUGIN    = $(BUILD)/distributed/frictionCG-mpi.o
MPI_OBJECTS   = $(MPI_PLUGIN) $(call objects,$(BUILD)/distributed/,$(filter-out %/frictionCG-mpi.cpp,$(MPI_SOURCES)))
PETSC_DIR    ?= $(firstword $(wildcard /usr/lib/petscdir/petsc-real /usr/lib/petsc))
PETSC_FLAGS   = $(shell pkg-config --cflags PETSc 2>/dev/null || echo -I$(PETSC_DIR)/include)
PETSC_LIBS    = $(shell pkg-config --libs PETSc 2>/dev/null || echo -L$(PETSC_DIR)/lib -lpetsc)
MPICXX       ?= mpicxx
# No -D that precompiled headers have not been made with
MPI_FLAGS     = $(patsubst -I%,-isystem %,$(filter-out -W% -D_FORTIFY_SOURCE%,$(PETSC_FLAGS)) $(shell $(MPICXX) --showme:compile))
MPI_LIBS      = $(PETSC_LIBS) $(shell $(MPICXX) --showme:link)

mpi: setup setup-mpi ## the plugin of several processes, on PETSc
	@$(MAKE) --no-print-directory -j$$(nproc) all $(BUILD)/frictionCG-mpi.so >/dev/null

setup-mpi:
	@$(MAKE) --no-print-directory setup PACKAGES="$(MPI_PACKAGES)"

$(BUILD)/distributed/%.o: $$(call sources,plugin/mpi/%) Makefile $(CORE_PCH:=.gch)
	@mkdir -p $(@D)
	$(CXX) $(FLAGS) $(DEPENDS) $(MPI_FLAGS) $(FF_FLAGS) $(addprefix $(READ) ,$(CORE_PCH)) $(call compiled,$(call sources,plugin/mpi/$*)) -o $@

# Beside the plugin, for tests/bench/mpi3d.edp
$(BUILD)/mpiUnit.so: tests/bench/distributed/mpiUnit.cpp $(MPI_OBJECTS) $(ADAPTERS) $(OBJECTS) $(HEADERS)
	$(CXX) $(FLAGS) $(MPI_FLAGS) $(FF_FLAGS) -Wno-shadow -shared $< \
	  $(filter-out $(MPI_PLUGIN),$(MPI_OBJECTS)) $(ADAPTERS) $(OBJECTS) -o $@ $(LIBS) $(MPI_LIBS)

# For tests/scarce/one and tests/mpi/scarce
$(BUILD)/scarce.so: tests/scarce/scarce.cpp
	$(CXX) -std=c++17 -fPIC $(CXXFLAGS) $(WARN) -shared $< -o $@

$(BUILD)/frictionCG-mpi.so: $(MPI_OBJECTS) $(ADAPTERS) $(OBJECTS)
	$(CXX) -shared $(OWN_NEW) $(LDFLAGS) $^ -o $@ $(LIBS) $(MPI_LIBS)

core: $(BUILD)/libfrictioncg.a ## the core as a library, used through plugin/core/frictioncg.h

$(BUILD)/libfrictioncg.a: $(OBJECTS)
	rm -f $@
	$(AR) rcs $@ $^

# A program outside FreeFEM: one header, one library.
$(BUILD)/two_springs: tests/unit/standalone/two_springs.cpp $(BUILD)/libfrictioncg.a
	$(CXX) $(FLAGS) $^ -o $@ $(LIBS)

# Beside the plugin: FreeFEM looks in the current folder before it looks where an older version is installed.
$(BUILD)/%.idp: edp/%.idp
	@mkdir -p $(@D)
	cp $< $@

demo: setup ## the block of the paper: displacement, contact forces, and their picture
	@$(MAKE) --no-print-directory -j$$(nproc) all >/dev/null
	cd $(BUILD) && $(RUN) $(CURDIR)/examples/block.edp

check: setup ## all tests; those of several processes after `make mpi`
	@$(MAKE) --no-print-directory -j$$(nproc) all $(BUILD)/unit_tests $(BUILD)/two_springs \
	  $(BUILD)/scarce.so $(WITH_MPI) $(if $(CI),$(BENCH_PLUGINS)) >/dev/null
	@bash tests/run $(BUILD)/unit_tests $(BUILD)/two_springs tests/figures tests/scarce/one $(SCRIPTS) \
	  $(EXAMPLES) $(PAGES) $(SHARED)

unit: all $(BUILD)/unit_tests ## unit tests of the core only
	$(BUILD)/unit_tests

scripts: all ## scripted tests in FreeFEM only
	@bash tests/run $(SCRIPTS)

shared: mpi ## scripted tests and examples under several processes only
	@$(MAKE) --no-print-directory $(BUILD)/scarce.so >/dev/null
	@bash tests/run $(SHARED)

examples: all ## every example, on coarse meshes
	@bash tests/run $(EXAMPLES)

pages: all ## every snippet of the README and of the manual, edp/doc
	@bash tests/run tests/figures $(PAGES)

# The core first: what it has inline is then what the tests run.
$(BUILD)/unit_tests: $(OBJECTS) $(TESTS)
	$(CXX) $(LDFLAGS) $(WRAP) $^ -o $@ -lgtest -lgtest_main -lpthread $(LIBS)

# test_faults.cpp counts allocations, and makes them fail
WRAP := -Wl,--wrap=malloc,--wrap=calloc,--wrap=realloc,--wrap=free

$(BUILD)/unit/%.o: $$(call sources,tests/unit/%) Makefile $(UNIT_PCH:=.gch)
	@mkdir -p $(@D)
	$(CXX) $(FLAGS) $(DEPENDS) -O1 -Itests $(addprefix $(READ) ,$(UNIT_PCH)) $(call compiled,$(call sources,tests/unit/$*)) -o $@

-include $(OBJECTS:.o=.d) $(TESTS:.o=.d) $(BUILD)/frictionCG.d $(ADAPTERS:.o=.d) $(MPI_OBJECTS:.o=.d)

# The benchmarks run in FreeFEM, with one thread unless they say so, in the same process as what they compare with.
$(BUILD)/%.so: tests/bench/%.cpp tests/bench/on_scene.h $(ADAPTERS) $(OBJECTS) $(HEADERS)
	$(CXX) $(FLAGS) $(FF_FLAGS) -Wno-shadow -Wno-use-after-free -shared $< $(ADAPTERS) $(OBJECTS) -o $@ $(LIBS)

bench: setup ## the paper's tables, and costs as ratios to one linear solve
	@$(MAKE) --no-print-directory -j$$(nproc) all $(BENCH_PLUGINS) >/dev/null
	@for script in tests/bench/paper.edp tests/bench/cost.edp \
	  tests/bench/roller.edp tests/bench/multigrid3d.edp; do \
	  (cd $(BUILD) && OPENBLAS_NUM_THREADS=1 $(RUN) ../$$script) || exit 1; done
	@cd $(BUILD) && OPENBLAS_NUM_THREADS=1 /usr/bin/python3 ../tests/bench/rollerPeer.py roller.csv \
	  || echo "GetFEM did not run: left out of CB1"
	@$(if $(WITH_MPI),$(MAKE) --no-print-directory scaling,echo "left out: several processes; \`make mpi\` adds them")

# Cells along an edge: 118 000 and 353 000 dofs on 1 and 2 processes, for which 3 GB of memory do; then 14 000 dofs on more
# processes than there are cores: iterations alone count there.
CELLS ?= 33 48
MANY  ?= 16

scaling: mpi ## the cost of several processes, over PETSc's linear solves
	@$(MAKE) --no-print-directory $(BUILD)/mpiUnit.so >/dev/null
	@. tests/mpi/environment; cd $(BUILD); for run in $(foreach n,$(CELLS),"1 $n" "2 $n") $(foreach p,1 2 4 8,"$p $(MANY)"); do set -- $$run; \
	  mpirun -np $$1 $(FF_PROGRAM_MPI) -nw -v 0 ../tests/bench/mpi3d.edp -n $$2 -repeat 3 || exit 1; done

# Peers and tools of the report; one that cannot be installed is left out, and the report says so.
PEERS := python3-numpy python3-scipy python3-getfem python3-siconos valgrind

report: setup ## error against run time with the peers, stability, what is left out: report/report.md
	@$(MAKE) --no-print-directory setup PACKAGES="python3 fonts-dejavu-core"
	@for p in $(PEERS); do $(MAKE) --no-print-directory setup PACKAGES=$$p || true; done
	@$(MAKE) --no-print-directory -j$$(nproc) all $(BUILD)/costUnit.so $(BUILD)/unit_tests >/dev/null
	@bash tests/bench/report.sh

format: ## clang-format on our own code
	clang-format -i $(OWN)

lint: ## no warning, clang-tidy, the core free of FreeFEM and of output, no include against the order of its folders
	@$(MAKE) --no-print-directory -j$$(nproc) CI=1 PRECOMPILED= TOGETHER=1 BUILD=$(BUILD)/lint all $(BUILD)/lint/unit_tests >/dev/null
	@! grep -rlE 'ff\+\+|freefem|<iostream>|printf' plugin/core
	@above="answer|cost|solver"; for folder in sparse condensed gradient multigrid statics assembly model; do \
	  ! grep -rnE "#include \"($$above)" plugin/core/$$folder || exit 1; above="$$above|$$folder/"; done
	clang-format --dry-run -Werror $(OWN)
	clang-tidy --quiet $(CORE) -- -std=c++17 $(INCLUDE)

# FreeFEM's headers call members of null pointers, and the tests' own operator new is not all of them.
sanitize: ## unit and scripted tests under ASan and UBSan
	@$(MAKE) --no-print-directory BUILD=$(BUILD)/sanitize LDFLAGS="-fsanitize=address,undefined" \
	  CXXFLAGS="-O1 -g -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-sanitize=null,vptr" \
	  all $(BUILD)/sanitize/unit_tests
	ASAN_OPTIONS=alloc_dealloc_mismatch=0 $(BUILD)/sanitize/unit_tests
	@ln -sfn $(CURDIR)/tests $(BUILD)/tests  # what scripts include by ../tests
	FF_LOADPATH="$(CURDIR)/$(BUILD)/sanitize;$(FF_PLUGINS)" FF_INCLUDEPATH="$(CURDIR)/$(BUILD)/sanitize;$(FF_IDP)" \
	BUILD=$(BUILD)/sanitize \
	LD_PRELOAD="$$($(CXX) -print-file-name=libasan.so) $$($(CXX) -print-file-name=libubsan.so)" \
	ASAN_OPTIONS=detect_leaks=0:alloc_dealloc_mismatch=0 bash tests/run $(SCRIPTS)

mutants: ## one-line faults in plugin and edp, each noticed by a test; ONLY="word ..." names files
	@$(MAKE) --no-print-directory setup PACKAGES="$(PACKAGES) python3" >/dev/null
	@$(MAKE) --no-print-directory -j$$(nproc) BUILD=$(BUILD)/mutants TOGETHER=1 CXXFLAGS=-O1 all \
	  $(BUILD)/mutants/unit_tests $(WITH_MPI:$(BUILD)/%=$(BUILD)/mutants/%) >/dev/null
	@FF_PLUGINS="$(FF_PLUGINS)" FF_IDP="$(FF_IDP)" python3 tests/mutants/run.py $(BUILD)/mutants $$(nproc) $(ONLY)

# What stays unreached: messages of internal errors and of more than 2^31 entries; closing braces that only an
# exception passes; a field of NaN; a fixed point that diverges although damped, or whose inner tolerance alone
# is left to tighten; stop_on_step, which only the paper's tables (make bench) use; one branch of a template
# in one of its instances.
coverage: ## lines of plugin/core that no unit test reaches
	@$(MAKE) --no-print-directory -j$$(nproc) BUILD=$(BUILD)/coverage LDFLAGS=--coverage \
	  CORE_FLAGS="-O1 --coverage" $(BUILD)/coverage/unit_tests >/dev/null
	@find $(BUILD)/coverage -name '*.gcda' -delete
	@$(BUILD)/coverage/unit_tests >/dev/null
	@gcov -r -t $$(find $(BUILD)/coverage/core -name '*.gcda') 2>/dev/null | awk -F: '/Source:/ {name = $$4} \
	  /^ *[#=]+:/ {print "  " name ":" $$2 + 0 ":" substr($$0, 17); missed++} /^ *[0-9]+\*?:/ {reached++} \
	  END {printf "%d of %d lines of plugin/core reached\n", reached, reached + missed}'

# Where FreeFEM looks, under PREFIX in place of FreeFEM's own prefix, and under DESTDIR while a package is made.
PLUGINS_TO = $(DESTDIR)$(FF_PLUGINS:$(FF_PREFIX)/%=$(PREFIX)/%)
IDP_TO     = $(DESTDIR)$(FF_IDP:$(FF_PREFIX)/%=$(PREFIX)/%)

install: all ## the plugin and the .idp files where FreeFEM looks; then an example from there
	install -d $(PLUGINS_TO) $(IDP_TO)
	install -m 644 $(BUILD)/frictionCG.so $(WITH_MPI) $(PLUGINS_TO)
	@# FreeFem++-mpi looks nowhere else where there is a folder mpi
	if [ -d $(FF_PLUGINS)/mpi ]; then install -D -m 644 -t $(PLUGINS_TO)/mpi $(BUILD)/frictionCG.so $(WITH_MPI); fi
	install -m 644 $(IDP) $(IDP_TO)
	@# Debian's preferences name folders that do not exist: add those that do. A private PREFIX is not theirs.
	@pref=$(DESTDIR)/etc/freefem++.pref; \
	add() { grep -qF "\"$$2\"" $$pref || { echo "$$pref: $$1 += \"$$2\""; echo "$$1 += \"$$2\"" >>$$pref; }; }; \
	if [ -n "$(and $(filter /usr /usr/local,$(PREFIX)),$(if $(FREEFEM),,debian))" ] && [ -w $$pref ]; then \
	  add loadpath $(PLUGINS_TO:$(DESTDIR)%=%); add loadpath $(FF_PLUGINS); \
	  add includepath $(IDP_TO:$(DESTDIR)%=%); add includepath $(FF_IDP); fi
	@DESTDIR="$(DESTDIR)" bash tests/installed $(PLUGINS_TO) $(IDP_TO) $(FF_PLUGINS) $(FF_IDP)

# Bases of the systems, as debootstrap makes them; BASES may name a folder that has them already.
SYSTEMS ?= trixie bookworm
BASES   ?= $(BUILD)/fresh

fresh: ## the README's commands in fresh minimal systems of Debian 12 and 13 (root)
	@$(MAKE) --no-print-directory setup PACKAGES="debootstrap git"
	@bash tests/fresh $(BASES) $(BUILD)/fresh $(SYSTEMS)

clean: ## remove what was built
	rm -rf $(BUILD)
