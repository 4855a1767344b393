#!/usr/bin/env bash
# The test command: installs what the tests need where it is missing, then runs every check.
# The last line is `N passed, N failed`; the exit status is 0 only if nothing failed.
#
# GPU tests run on software devices alone, whatever else the machine has: Mesa's lavapipe and SwiftShader by Vulkan,
# Mesa's llvmpipe by OpenGL without a display.
set -uo pipefail
exec < /dev/null
cd "$(dirname "$0")/.."
export CARGO_TERM_COLOR=never

passed=0
failed=0
failures=()

# check NAME COMMAND...: one check, passed if the command succeeds.
check() {
    local name=$1
    shift
    printf '\n== %s\n' "$name"
    if "$@"; then
        passed=$((passed + 1))
    else
        failed=$((failed + 1))
        failures+=("$name")
    fi
}

# check_tests NAME COMMAND...: a run of cargo test, counted by its tests.
check_tests() {
    local name=$1 output ok bad status
    shift
    printf '\n== %s\n' "$name"
    output=$(mktemp)
    "$@" 2>&1 | tee "$output"
    status=$?
    read -r ok bad < <(awk '/^test result:/ { ok += $4; bad += $6 } END { print ok + 0, bad + 0 }' "$output")
    rm -f "$output"
    passed=$((passed + ok))
    # A runner that did not build, crashed or found no test has no failed test to count.
    if [ "$bad" -eq 0 ] && { [ $status -ne 0 ] || [ "$ok" -eq 0 ]; }; then
        bad=1
    fi
    failed=$((failed + bad))
    [ "$bad" -eq 0 ] || failures+=("$name: $bad")
}

# What a machine needs besides a Rust toolchain: a linker, and three software devices from independent compilers.
packages=(
    gcc g++ libc6-dev # g++ for meshopt, beside which tangents are measured
    libvulkan1 mesa-vulkan-drivers
    libegl1 libgles2 libgl1-mesa-dri
    glslang-tools spirv-tools # compilers of the exported shaders
    chromium # the page of `texbake verify --html`, and SwiftShader's Vulkan driver
)
# The Khronos validator of glTF. Some systems have npm in the package of node.
if ! command -v node > /dev/null || ! command -v npm > /dev/null; then
    packages+=(nodejs npm)
fi

# The Python of the other readers of textures. Debian keeps what makes environments in a package of its own.
if ! python3 -c 'import ensurepip' 2> /dev/null; then
    packages+=(python3-venv)
fi

install_packages() {
    local package absent=() sudo=()
    if ! command -v dpkg-query > /dev/null; then
        echo "no Debian system: needs by other means what Debian calls ${packages[*]}"
        return 0
    fi
    for package in "${packages[@]}"; do
        [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2> /dev/null)" = installed ] || absent+=("$package")
    done
    if [ ${#absent[@]} -eq 0 ]; then
        echo "all installed: ${packages[*]}"
        return 0
    fi
    if [ "$(id -u)" -ne 0 ]; then
        sudo=(sudo -n)
        if ! sudo -n true 2> /dev/null; then
            echo "cannot install without root; run this first: apt-get install --no-install-recommends ${absent[*]}"
            return 1
        fi
    fi
    "${sudo[@]}" apt-get update -q \
        && "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive \
            apt-get install -q -y --no-install-recommends "${absent[@]}"
}

# first_file NAME FOLDER...: the first file of that name (a pattern) under the folders.
first_file() {
    local name=$1
    shift
    find "$@" -name "$name" 2> /dev/null | sort | head -n 1
}

choose_software_devices() {
    local lavapipe swiftshader mesa
    lavapipe=$(first_file 'lvp_icd*.json' /usr/share/vulkan /usr/local/share/vulkan /etc/vulkan)
    swiftshader=$(first_file 'vk_swiftshader_icd.json' /usr/lib /usr/lib64 /opt /usr/local/lib)
    mesa=$(first_file '*mesa.json' /usr/share/glvnd/egl_vendor.d /etc/glvnd/egl_vendor.d)
    echo "lavapipe: ${lavapipe:-missing}"
    echo "SwiftShader: ${swiftshader:-missing}"
    echo "Mesa's EGL: ${mesa:-missing}"
    export VK_DRIVER_FILES=$lavapipe:$swiftshader
    # The name of the same setting before Vulkan's loader 1.3.207.
    export VK_ICD_FILENAMES=$VK_DRIVER_FILES
    # Drivers beside these may add themselves, and layers may print or slow down.
    unset VK_ADD_DRIVER_FILES VK_INSTANCE_LAYERS VK_LOADER_LAYERS_ENABLE
    # llvmpipe, without a window system.
    export __EGL_VENDOR_LIBRARY_FILENAMES=$mesa
    export LIBGL_ALWAYS_SOFTWARE=1 EGL_PLATFORM=surfaceless
    unset DISPLAY WAYLAND_DISPLAY
    # Mesa complains where there is none.
    export XDG_RUNTIME_DIR=${XDG_RUNTIME_DIR:-${TMPDIR:-/tmp}}
    # A device that is missing is a failure, not a test passed over.
    export TEXBAKE_REQUIRE_GPU=1
    [ -n "$lavapipe" ] && [ -n "$swiftshader" ] && [ -n "$mesa" ]
}

# The browser that runs the page of `texbake verify --html`: a second WGSL compiler and WebGPU implementation.
find_browser() {
    local name
    # A browser that is missing is a failure, not a test passed over.
    export TEXBAKE_REQUIRE_BROWSER=1
    for name in "${TEXBAKE_CHROMIUM:-chromium}" chromium-browser google-chrome; do
        command -v "$name" && return 0
    done
    return 1
}

# The compilers that the exported shaders are given to.
require_shader_tools() {
    # A tool that is missing is a failure, not a test passed over.
    export TEXBAKE_REQUIRE_SHADER_TOOLS=1
    command -v glslangValidator && command -v spirv-val
}

# The maps of real materials, from the source package of pypbr on PyPI: fetched once, kept with the build, never in git.
# Without a network their tests print that they were not run; TEXBAKE_REQUIRE_MATERIALS=1 makes that a failure.
fetch_materials() {
    local name=pypbr-0.1.0b5 folder
    local sha256=65bf9ad4e2839bff487ca3aac3026380983116103409849709fe8d47fc85d80b
    folder=${CARGO_TARGET_DIR:-$PWD/target}/materials
    if [ ! -e "$folder/$name/complete" ]; then
        mkdir -p "$folder/$name"
        python3 -m pip download --quiet --no-deps --no-binary pypbr --dest "$folder" "${name/-/==}" \
            && echo "$sha256  $folder/$name.tar.gz" | sha256sum --check --quiet \
            && tar -xzf "$folder/$name.tar.gz" -C "$folder" "$name/tests/data" \
            && touch "$folder/$name/complete"
        rm -f "$folder/$name.tar.gz"
    fi
    if [ ! -e "$folder/$name/complete" ]; then
        echo "$name is out of reach: the tests of real materials are not run"
        [ "${TEXBAKE_REQUIRE_MATERIALS:-0}" != 1 ]
        return
    fi
    export TEXBAKE_MATERIALS=$folder/$name/tests/data
    echo "$TEXBAKE_MATERIALS"
}

# npm_package NAME SHA256 FOLDER: unpacks a package of npm, name@version, into a folder; fetched once.
npm_package() {
    local name=$1 sha256=$2 folder=$3 archive
    [ ! -e "$folder/complete" ] || return 0
    mkdir -p "$folder"
    archive=$folder/$(npm pack --silent --pack-destination "$folder" "$name" | tail -n 1) \
        && echo "$sha256  $archive" | sha256sum --check --quiet \
        && tar -xzf "$archive" -C "$folder" \
        && touch "$folder/complete"
    rm -f "$folder"/*.tgz
    [ -e "$folder/complete" ]
}

# The Khronos validator of glTF, from npm: kept with the build, never in git. Without node or a network its tests print
# that they were not run; TEXBAKE_REQUIRE_GLTF_VALIDATOR=1 makes that a failure.
fetch_validator() {
    local name=gltf-validator@2.0.0-dev.3.10 folder
    local sha256=4e03dbdc3bc0d1342afd5d2d7ae341a7e3474502ccb872b02dbbaddaee0fdec6
    folder=${CARGO_TARGET_DIR:-$PWD/target}/gltf-validator
    if ! command -v node > /dev/null || ! npm_package "$name" "$sha256" "$folder"; then
        echo "node or $name is out of reach: the validator's tests are not run"
        [ "${TEXBAKE_REQUIRE_GLTF_VALIDATOR:-0}" != 1 ]
        return
    fi
    export TEXBAKE_GLTF_VALIDATOR=$folder/package
    echo "$TEXBAKE_GLTF_VALIDATOR"
}

# Other readers of textures: ktx-parse from npm, Pillow and texture2ddecoder from PyPI, kept with the build, never in git.
# Without node, Python or a network their tests print that they were not run; TEXBAKE_REQUIRE_TEXTURE_READERS=1 makes
# that a failure.
fetch_texture_readers() {
    local name=ktx-parse@2.0.0 wheels=(pillow==12.0.0 texture2ddecoder==1.0.5) folder
    local sha256=608908d207488fb8500ed001aab046e78fc677238e4f867023a75f2d248baba1
    folder=${CARGO_TARGET_DIR:-$PWD/target}/texture-readers
    if [ ! -e "$folder/venv/complete" ]; then
        mkdir -p "$folder"
        python3 -m venv --clear "$folder/venv" \
            && "$folder/venv/bin/python3" -m pip install --quiet --disable-pip-version-check --no-deps "${wheels[@]}" \
            && touch "$folder/venv/complete"
    fi
    if [ ! -e "$folder/venv/complete" ] || ! command -v node > /dev/null || ! npm_package "$name" "$sha256" "$folder"; then
        echo "node, $name or ${wheels[*]} is out of reach: the tests of other readers of textures are not run"
        [ "${TEXBAKE_REQUIRE_TEXTURE_READERS:-0}" != 1 ]
        return
    fi
    export TEXBAKE_TEXTURE_READERS=$folder
    echo "$TEXBAKE_TEXTURE_READERS"
}

# The Stanford bunny from npm (public domain) as an OBJ, with x and y as texture coordinates.
bunny_as_obj() {
    node -e 'const { positions, cells } = require(process.argv[1]);
        for (const [x, y, z] of positions) console.log(`v ${x} ${y} ${z}\nvt ${x / 8} ${y / 8}`);
        for (const cell of cells) console.log("f", cell.map((at) => `${at + 1}/${at + 1}`).join(" "));' "$1"
}

# Real models, most of them with normal maps: the controllers of @webxr-input-profiles/assets (npm, MIT licence), only
# left hands, the right ones being their mirror images; and a scan. TEXBAKE_REQUIRE_MODELS=1 makes their absence a
# failure.
fetch_models() {
    local name=@webxr-input-profiles/assets@1.0.20 bunny=bunny@1.0.1 folder profile hand file
    local sha256=30df2a2268220fc0d0e034bed1550aabdd7a2500573c5216f64fc70d59c3d91e
    folder=${CARGO_TARGET_DIR:-$PWD/target}/models
    if [ ! -e "$folder/complete" ]; then
        mkdir -p "$folder"
        if npm_package "$name" "$sha256" "$folder/package"; then
            for profile in "$folder"/package/package/dist/profiles/*/; do
                case $(basename "$profile") in
                    generic-* | hp-* | magicleap-* | microsoft-* | samsung-* | pico-4u | oculus-touch) ;;
                    *) continue ;;
                esac
                for hand in left none; do
                    file=$profile$hand.glb
                    [ ! -e "$file" ] || mv "$file" "$folder/$(basename "$profile")-$hand.glb"
                done
            done
            touch "$folder/complete"
        fi
        rm -rf "$folder/package"
    fi
    if [ ! -e "$folder/bunny.obj" ] \
        && npm_package "$bunny" 381e02c74b98cf18814d7bec794726ef70b9c67e037273e82054d0043f6ae303 "$folder/bunny"; then
        bunny_as_obj "$folder/bunny/package" > "$folder/bunny.new" && mv "$folder/bunny.new" "$folder/bunny.obj"
        rm -rf "$folder/bunny"
    fi
    if [ ! -e "$folder/complete" ] || [ ! -e "$folder/bunny.obj" ]; then
        echo "$name or $bunny is out of reach: the tests of real models are not run"
        [ "${TEXBAKE_REQUIRE_MODELS:-0}" != 1 ]
        return
    fi
    export TEXBAKE_MODELS=$folder
    echo "$TEXBAKE_MODELS"
}

# The tests of full disks need one of their own, which a namespace gives; where the system forbids it, they say so.
require_mounts() {
    local mount='mount -t tmpfs -o size=16k tmpfs /mnt'
    if unshare -m sh -c "$mount" 2> /dev/null || unshare -rm sh -c "$mount" 2> /dev/null; then
        export TEXBAKE_REQUIRE_MOUNTS=1
        echo "a process may mount"
    else
        echo "no process may mount here: full disks are not tested"
    fi
}

# Without cargo-deny (its build takes minutes, so it is not installed here): every dependency offers one of the licences that deny.toml allows.
check_licences() {
    local allowed others
    allowed=$(awk '/^allow = \[/ { inside = 1 } inside && /^\]/ { exit } inside' deny.toml \
        | grep -oE '"[^"]+"' | tr -d '"' | paste -sd '|')
    others=$(cargo tree --locked --all-features --target all -e normal,build --prefix none --format '{p}: {l}') \
        || return 1
    others=$(printf '%s\n' "$others" | sort -u | grep -vE ": .*\b(${allowed//./\\.})\b")
    echo "cargo-deny is not installed: licences are checked by cargo tree, advisories, bans and sources are not"
    [ -z "$others" ] || { printf '%s\n' "$others"; return 1; }
}

check_dependencies() {
    if ! cargo deny --version > /dev/null 2>&1; then
        check_licences
    elif cargo deny --all-features fetch db > /dev/null 2>&1; then
        cargo deny --all-features check
    else
        echo "the database of advisories is out of reach: advisories are not checked"
        cargo deny --all-features check licenses bans sources
    fi
}

if ! command -v cargo > /dev/null; then
    [ -r "$HOME/.cargo/env" ] && . "$HOME/.cargo/env"
fi
if ! command -v cargo > /dev/null; then
    echo "cargo is missing: install a Rust toolchain of at least the version in Cargo.toml, from https://rustup.rs"
    echo "0 passed, 1 failed"
    exit 1
fi

check "packages" install_packages
check "software devices" choose_software_devices
check "browser" find_browser
check "shader tools" require_shader_tools
check "materials" fetch_materials
check "glTF validator" fetch_validator
check "texture readers" fetch_texture_readers
check "models" fetch_models
check "mounts" require_mounts
check "formatting" cargo fmt --check
check "lints" cargo clippy --release --all-targets -- -D warnings
check "lints without the gpu feature" cargo clippy --release --no-default-features --features cli -- -D warnings
check "lints of the library alone" cargo clippy --release --lib --no-default-features -- -D warnings
check_tests "tests" cargo test --release --no-fail-fast
# A kernel that became dearer on real GPUs, or spills registers, as RADV compiles it for cards that are not there.
check "kernel costs" cargo bench --bench gpu_cost
check "dependencies" check_dependencies

if [ $failed -gt 0 ]; then
    printf '\nfailed:\n'
    printf '  %s\n' "${failures[@]}"
fi
printf '\n%d passed, %d failed\n' "$passed" "$failed"
[ $failed -eq 0 ]
