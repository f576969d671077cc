"""What the programs are made of: writes DIRECTORY/NAME.cdx.json, the bill of materials (CycloneDX 1.5),
and DIRECTORY/LICENCES-NAME.txt, the licences of all libraries with their texts, for `wmr` and for the firmware.

    tests/bill_of_materials.py DIRECTORY

The same bytes for the same Cargo.lock. Standard library only; whether the licences are allowed is for
cargo-deny to say (deny.toml)."""
import json, pathlib, subprocess, sys, tomllib

ROOT = pathlib.Path(__file__).resolve().parent.parent
# The program's name, its package, and the platforms that its libraries are counted for.
PROGRAMS = [
    ("wmr", "wmr", []),
    ("firmware", "wmr-firmware", ["thumbv6m-none-eabi", "thumbv8m.main-none-eabihf"]),
]
TEXTS = ("LICENSE", "LICENCE", "COPYING", "NOTICE", "UNLICENSE")


def metadata(targets):
    filters = [word for target in targets for word in ("--filter-platform", target)]
    command = ["cargo", "metadata", "--format-version", "1", "--locked", *filters]
    return json.loads(subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, check=True).stdout)


def reached(nodes, root):
    """The packages that end up in a program or build it, without those that only its tests use."""
    found, waiting = {}, [root]
    while waiting:
        name = waiting.pop()
        if name not in found:
            kinds = lambda dep: {kind["kind"] for kind in dep["dep_kinds"]}
            below = [dep["pkg"] for dep in nodes[name]["deps"] if kinds(dep) & {None, "build"}]
            found[name] = sorted(below)
            waiting += below
    return found


def licence_texts(package):
    folder = pathlib.Path(package["manifest_path"]).parent
    files = [file for file in folder.iterdir() if file.name.upper().startswith(TEXTS) and file.is_file()]
    return [file.read_text(errors="replace").strip() for file in sorted(files)]


def main(directory):
    checksums = {
        (entry["name"], entry["version"]): entry.get("checksum")
        for entry in tomllib.loads((ROOT / "Cargo.lock").read_text())["package"]
    }
    directory.mkdir(parents=True, exist_ok=True)
    for name, root, targets in PROGRAMS:
        write(directory, name, root, metadata(targets), checksums)


def write(directory, name, root, data, checksums):
    packages = {package["id"]: package for package in data["packages"]}
    nodes = {node["id"]: node for node in data["resolve"]["nodes"]}
    top = next(package for package in data["packages"] if package["name"] == root)
    found = reached(nodes, top["id"])
    purl = lambda package: f"pkg:cargo/{package['name']}@{package['version']}"
    order = sorted(found, key=lambda key: purl(packages[key]))
    components, licences = [], []
    for package in (packages[key] for key in order if key != top["id"]):
        component = {
            "type": "library",
            "bom-ref": purl(package),
            "name": package["name"],
            "version": package["version"],
            "purl": purl(package),
            # An old way to write "or", which the standard does not know.
            "licenses": [{"expression": package["license"].replace("/", " OR ")}],
        }
        checksum = checksums[package["name"], package["version"]]
        if checksum:
            component["hashes"] = [{"alg": "SHA-256", "content": checksum}]
            licences.append((package, licence_texts(package)))
        components.append(component)
    bill = {
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": {
            "component": {
                "type": "application",
                "bom-ref": purl(top),
                "name": top["name"],
                "version": top["version"],
                "purl": purl(top),
            }
        },
        "components": components,
        "dependencies": [
            {"ref": purl(packages[key]), "dependsOn": [purl(packages[below]) for below in found[key]]}
            for key in order
        ],
    }
    (directory / f"{name}.cdx.json").write_text(json.dumps(bill, indent=1) + "\n")
    (directory / f"LICENCES-{name}.txt").write_text(licence_document(name, licences))


def licence_document(name, licences):
    """Who is under which licence, then every text once, with those that carry it."""
    parts, carriers = [f"Libraries in {name} that others have written, and their licences.\n"], {}
    for package, texts in licences:
        title = f"{package['name']} {package['version']}"
        parts.append(f"{title}: {package['license']}" + ("" if texts else " (without a text of it)"))
        for text in texts:
            carriers.setdefault(text, []).append(title)
    for text, titles in carriers.items():
        parts.append(f"\n{'=' * 78}\n{', '.join(titles)}\n{'=' * 78}\n\n{text}")
    return "\n".join(parts) + "\n"


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    main(pathlib.Path(sys.argv[1]))
