//! What a firmware takes of flash and memory: `size FIRMWARE` prints the bytes of text, data and bss, as `size` does.

use std::error::Error;

use object::elf::{SHF_ALLOC, SHF_WRITE, SHT_NOBITS};
use object::read::elf::{FileHeader, SectionHeader};
use object::{Endianness, elf};

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("which file?")?;
    let bytes = std::fs::read(&path)?;
    let [mut text, mut data, mut bss] = [0; 3];
    let header = elf::FileHeader32::<Endianness>::parse(&*bytes)?;
    let endian = header.endian()?;
    for section in header.sections(endian, &*bytes)?.iter() {
        let (flags, size) = (section.sh_flags(endian), section.sh_size(endian));
        match ((flags & SHF_ALLOC).0 != 0, (flags & SHF_WRITE).0 != 0) {
            (false, _) => {} // names and debugging information, which are not loaded
            (true, false) => text += size,
            (true, true) if section.sh_type(endian) == SHT_NOBITS => bss += size,
            (true, true) => data += size,
        }
    }
    println!("{path}: text {text}, data {data}, bss {bss} bytes; flash {}, memory {}", text + data, data + bss);
    Ok(())
}
