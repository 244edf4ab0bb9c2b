# Shared by the scripts: what a Debian machine needs beside the Rust toolchain.

# Says in one sentence what is missing and ends.
missing() {
    echo "$0: $*" >&2
    exit 1
}

# Installs Debian packages unless all of them are there.
need_packages() {
    local wanted=() package
    for package in "$@"; do
        dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || wanted+=("$package")
    done
    [ ${#wanted[@]} -eq 0 ] && return
    command -v apt-get >/dev/null || missing "please install these packages yourself: ${wanted[*]}"
    local root=()
    [ "$(id -u)" -eq 0 ] || root=(sudo)
    "${root[@]}" apt-get update -qq
    DEBIAN_FRONTEND=noninteractive "${root[@]}" apt-get install -y -qq --no-install-recommends "${wanted[@]}"
}

# The Vulkan loader and Mesa's drivers, one of which computes on the CPU where there is no GPU. Images need none.
need_driver() {
    command -v dpkg-query >/dev/null || return 0
    need_packages libvulkan1 mesa-vulkan-drivers
}

# What windows under X11 load while they run, and what draws them.
need_window() {
    need_driver
    command -v dpkg-query >/dev/null || return 0
    need_packages libxcursor1 libxi6 libxkbcommon-x11-0 "$@"
}

set_up() {
    if ! command -v cargo >/dev/null && [ -f "$HOME/.cargo/env" ]; then
        . "$HOME/.cargo/env"
    fi
    command -v cargo >/dev/null || missing "the Rust toolchain is missing: install it from https://rustup.rs"
    if command -v dpkg-query >/dev/null; then
        # A linker and the C library's files.
        need_packages gcc libc6-dev
    else
        command -v cc >/dev/null || missing "a C linker (gcc or clang) is missing"
    fi
    if [ -z "${XDG_RUNTIME_DIR:-}" ]; then
        XDG_RUNTIME_DIR=$(mktemp -d)
        export XDG_RUNTIME_DIR
    fi
}
