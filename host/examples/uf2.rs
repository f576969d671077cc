//! Writes the UF2 file of an ELF file beside it: `cargo run -p wmr --example uf2 -- FILE.elf ...`

use std::error::Error;
use std::path::PathBuf;
use std::{env, fs};
use wmr::uf2::Image;

fn main() -> Result<(), Box<dyn Error>> {
    for path in env::args_os().skip(1).map(PathBuf::from) {
        let image = Image::from_elf(&fs::read(&path)?)?;
        fs::write(path.with_extension("uf2"), image.to_uf2())?;
    }
    Ok(())
}
