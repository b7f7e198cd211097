//! What is done of an ensemble, kept in files that are appended to alone: a run that is killed, or loses its power,
//! loses the members it was at and nothing else.
//!
//! A folder beside the table to be has one text, what it is an ensemble of, and a file of records for each process
//! that has worked on it. A record is some members in a row:
//!
//! | bytes | |
//! |---|---|
//! | 8 | the index of the first |
//! | 4 | how many |
//! | 4 | the length of what follows, without the last four |
//! | … | each member's quantities, 8 bytes each, then the length of why it stopped, 2 bytes, and why, as UTF-8 |
//! | 4 | CRC-32 of all before |
//!
//! All numbers are little-endian. What does not fit its sum, at the end of a file, was being written when the run
//! ended, and is made again.

use std::fs::{self, File, OpenOptions, TryLockError};
use std::io::{self, BufReader, Read, Seek, SeekFrom, Write};
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use crate::error::SweepError;

/// What came of one member.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Its quantities; NaN where there is none, all of them where the motion stopped.
    pub quantities: Vec<f64>,
    /// Why it stopped before its end, if it did.
    pub stopped: Option<String>,
}

/// What an ensemble is made of: if any of it changes, what was done is of another ensemble.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Identity(Vec<(String, String)>);

impl Identity {
    /// Of parts, each with its name (`plan`) and its digest.
    pub fn new(parts: impl IntoIterator<Item = (&'static str, String)>) -> Self {
        Identity(parts.into_iter().map(|(name, digest)| (name.to_string(), digest)).collect())
    }

    /// Name and digest of each part.
    pub fn parts(&self) -> impl Iterator<Item = (&str, &str)> {
        self.0.iter().map(|(name, digest)| (name.as_str(), digest.as_str()))
    }

    fn text(&self) -> String {
        self.0.iter().map(|(name, digest)| format!("{name}: {digest}\n")).collect()
    }

    /// The names of what differs from a text.
    fn differences(&self, text: &str) -> Vec<String> {
        let lines: Vec<&str> = text.lines().collect();
        let differs = |(name, digest): &&(String, String)| !lines.contains(&format!("{name}: {digest}").as_str());
        self.0.iter().filter(differs).map(|(name, _)| format!("the {name}")).collect()
    }
}

/// The SHA-256 of some bytes: `sha256:` and hexadecimal digits.
pub fn digest(bytes: &[u8]) -> String {
    use sha2::Digest;
    let digits: String = sha2::Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect();
    format!("sha256:{digits}")
}

/// The name of the text that says what a folder is of.
const IDENTITY: &str = "ensemble";

/// The name of the file that whoever makes the table locks.
const MERGER: &str = "merger";

/// What the names of files of records begin with.
const ROWS: &str = "rows-";

/// The folder of an ensemble that is not finished.
#[derive(Clone, Debug)]
pub(crate) struct Folder {
    path: PathBuf,
    quantities: usize,
}

/// Where a record is.
#[derive(Clone, Copy, Debug)]
struct Place {
    first: u64,
    count: u64,
    file: usize,
    offset: u64,
    length: usize,
}

impl Folder {
    /// That of a table to be.
    pub(crate) fn beside(table: &Path, quantities: usize) -> Self {
        let mut name = table.file_name().unwrap_or_default().to_os_string();
        name.push(".parts");
        Folder { path: table.with_file_name(name), quantities }
    }

    /// Where it is.
    pub(crate) fn path(&self) -> &Path {
        &self.path
    }

    /// A file in it that is not yet whole.
    pub(crate) fn unfinished(&self) -> PathBuf {
        self.path.join("table")
    }

    /// Makes the folder, or finds it with the same identity.
    pub(crate) fn open(&self, identity: &Identity) -> Result<(), SweepError> {
        let text = self.path.join(IDENTITY);
        match fs::read_to_string(&text) {
            Ok(found) => {
                let changed = identity.differences(&found);
                if changed.is_empty() { Ok(()) } else { Err(SweepError::changed(&self.path, &changed)) }
            }
            Err(error) if error.kind() == io::ErrorKind::NotFound => {
                fs::create_dir_all(&self.path).map_err(|error| SweepError::io("make", &self.path, error))?;
                // Ranks that begin together write the same text, each to a file of its own first.
                let draft = self.path.join(format!("{IDENTITY}-{}", std::process::id()));
                let written = File::create(&draft).and_then(|mut file| {
                    file.write_all(identity.text().as_bytes())?;
                    file.sync_all()
                });
                written.map_err(|error| SweepError::io("write", &draft, error))?;
                fs::rename(&draft, &text).map_err(|error| SweepError::io("write", &text, error))
            }
            Err(error) => Err(SweepError::io("read", &text, error)),
        }
    }

    /// Whether it is there.
    pub(crate) fn exists(&self) -> bool {
        self.path.join(IDENTITY).exists()
    }

    /// The files of records, sorted by name.
    fn files(&self) -> Result<Vec<PathBuf>, SweepError> {
        let failed = |error| SweepError::io("read", &self.path, error);
        let mut files = Vec::new();
        for entry in fs::read_dir(&self.path).map_err(failed)? {
            let entry = entry.map_err(failed)?;
            if entry.file_name().to_string_lossy().starts_with(ROWS) {
                files.push(entry.path());
            }
        }
        files.sort();
        Ok(files)
    }

    /// The records of a file, and where its good part ends.
    fn records(&self, path: &Path, file: usize) -> Result<(Vec<Place>, u64), SweepError> {
        let failed = |error| SweepError::io("read", path, error);
        let opened = File::open(path).map_err(failed)?;
        let end = opened.metadata().map_err(failed)?.len();
        let mut reader = BufReader::new(opened.take(end));
        let (mut places, mut offset) = (Vec::new(), 0);
        let mut payload = Vec::new();
        loop {
            let mut head = [0; 16];
            if reader.read_exact(&mut head).is_err() {
                return Ok((places, offset));
            }
            let (first, count, length) = parsed(&head);
            let behind = offset + 16 + length + 4;
            if behind > end {
                return Ok((places, offset));
            }
            payload.resize(length as usize + 4, 0);
            reader.read_exact(&mut payload).map_err(failed)?;
            let (rows, sum) = payload.split_at(length as usize);
            if sum != checksum(&head, rows) {
                return Ok((places, offset));
            }
            places.push(Place { first, count, file, offset: offset + 16, length: length as usize });
            offset = behind;
        }
    }

    /// All records, in the order of their members.
    fn all(&self) -> Result<(Vec<PathBuf>, Vec<Place>), SweepError> {
        let files = self.files()?;
        let mut places = Vec::new();
        for (number, file) in files.iter().enumerate() {
            places.extend(self.records(file, number)?.0);
        }
        places.sort_by_key(|place| (place.first, place.count));
        Ok((files, places))
    }

    /// The parts of a range that are not done.
    pub(crate) fn missing(&self, range: Range<u64>) -> Result<Vec<Range<u64>>, SweepError> {
        let (_, places) = self.all()?;
        let (mut missing, mut next) = (Vec::new(), range.start);
        for place in places {
            let (first, end) = (place.first.min(range.end), (place.first + place.count).min(range.end));
            if first > next {
                missing.push(next..first);
            }
            next = next.max(end);
        }
        if next < range.end {
            missing.push(next..range.end);
        }
        Ok(missing)
    }

    /// Calls `each` with every member from 0 to `members`, in order.
    pub(crate) fn rows(
        &self,
        members: u64,
        mut each: impl FnMut(u64, Row) -> Result<(), SweepError>,
    ) -> Result<(), SweepError> {
        let (files, places) = self.all()?;
        let mut opened: Vec<Option<File>> = files.iter().map(|_| None).collect();
        let (mut next, mut payload) = (0, Vec::new());
        for place in places {
            if place.first + place.count <= next {
                continue;
            }
            if place.first > next {
                return Err(SweepError::Missing { first: next, last: place.first - 1 });
            }
            let path = &files[place.file];
            let failed = |error| SweepError::io("read", path, error);
            let file = match &mut opened[place.file] {
                Some(file) => file,
                slot => slot.insert(File::open(path).map_err(failed)?),
            };
            file.seek(SeekFrom::Start(place.offset)).map_err(failed)?;
            payload.resize(place.length, 0);
            file.read_exact(&mut payload).map_err(failed)?;
            let rows = self.decoded(&payload, place.count).ok_or_else(|| failed(io::ErrorKind::InvalidData.into()))?;
            for (index, row) in (place.first..).zip(rows) {
                if index >= next && index < members {
                    each(index, row)?;
                }
            }
            next = place.first + place.count;
        }
        if next < members { Err(SweepError::Missing { first: next, last: members - 1 }) } else { Ok(()) }
    }

    fn decoded(&self, mut payload: &[u8], count: u64) -> Option<Vec<Row>> {
        let mut rows = Vec::new();
        for _ in 0..count {
            let (numbers, rest) = payload.split_at_checked(8 * self.quantities)?;
            let number = |bytes: &[u8]| bytes.try_into().ok().map(f64::from_le_bytes);
            let quantities = numbers.chunks(8).map(number).collect::<Option<_>>()?;
            let (length, rest) = rest.split_first_chunk()?;
            let (reason, rest) = rest.split_at_checked(usize::from(u16::from_le_bytes(*length)))?;
            let stopped = (!reason.is_empty()).then(|| String::from_utf8_lossy(reason).into_owned());
            rows.push(Row { quantities, stopped });
            payload = rest;
        }
        payload.is_empty().then_some(rows)
    }

    /// A file in it that no other process has locked, or will until it is closed.
    fn locked(&self, name: &str) -> Result<(PathBuf, File), SweepError> {
        let path = self.path.join(name);
        let opened = OpenOptions::new().read(true).append(true).create(true).open(&path);
        let file = opened.map_err(|error| SweepError::io("write", &path, error))?;
        match file.try_lock() {
            Err(TryLockError::WouldBlock) => Err(SweepError::Busy { path }),
            // Where a file system knows no locks, nothing is known of other processes.
            Ok(()) | Err(TryLockError::Error(_)) => Ok((path, file)),
        }
    }

    /// What only one process has at a time: the right to make the table.
    pub(crate) fn merger(&self) -> Result<File, SweepError> {
        self.locked(MERGER).map(|(_, file)| file)
    }

    /// The file that one of some processes appends to, without what was not finished there.
    pub(crate) fn journal(&self, rank: u64, ranks: u64) -> Result<Journal, SweepError> {
        let (path, file) = self.locked(&format!("{ROWS}{rank}-of-{ranks}"))?;
        let failed = |error| SweepError::io("write", &path, error);
        let (_, end) = self.records(&path, 0)?;
        if file.metadata().map_err(failed)?.len() > end {
            file.set_len(end).map_err(failed)?;
        }
        Ok(Journal { path, file, synced: Instant::now() })
    }

    /// Takes the folder away, once the table is whole.
    pub(crate) fn remove(&self) -> Result<(), SweepError> {
        let failed = |error| SweepError::io("remove", &self.path, error);
        for file in self.files()? {
            fs::remove_file(file).map_err(failed)?;
        }
        for file in [self.unfinished(), self.path.join(MERGER), self.path.join(IDENTITY)] {
            match fs::remove_file(file) {
                Err(error) if error.kind() != io::ErrorKind::NotFound => return Err(failed(error)),
                _ => {}
            }
        }
        fs::remove_dir(&self.path).map_err(failed)
    }
}

/// The head of a record: first, count, length.
fn parsed(head: &[u8; 16]) -> (u64, u64, u64) {
    let word =
        |range: Range<usize>| head[range].iter().rev().fold(0_u64, |number, byte| number << 8 | u64::from(*byte));
    (word(0..8), word(8..12), word(12..16))
}

fn checksum(head: &[u8], rows: &[u8]) -> [u8; 4] {
    let mut sum = crc32fast::Hasher::new();
    sum.update(head);
    sum.update(rows);
    sum.finalize().to_le_bytes()
}

/// A file of records that one process appends to.
#[derive(Debug)]
pub(crate) struct Journal {
    path: PathBuf,
    file: File,
    synced: Instant,
}

impl Journal {
    /// Appends members that follow each other.
    pub(crate) fn append(&mut self, first: u64, rows: &[Row]) -> Result<(), SweepError> {
        /// What is lost at most if the power fails.
        const PATIENCE: Duration = Duration::from_secs(1);
        let mut payload = Vec::new();
        for row in rows {
            row.quantities.iter().for_each(|number| payload.extend(number.to_le_bytes()));
            let reason = row.stopped.as_deref().unwrap_or_default();
            let reason = &reason.as_bytes()[..reason.len().min(usize::from(u16::MAX))];
            payload.extend((reason.len() as u16).to_le_bytes());
            payload.extend(reason);
        }
        let mut record = first.to_le_bytes().to_vec();
        record.extend((rows.len() as u32).to_le_bytes());
        record.extend((payload.len() as u32).to_le_bytes());
        let sum = checksum(&record, &payload);
        record.extend(payload);
        record.extend(sum);
        self.file.write_all(&record).map_err(|error| SweepError::io("write", &self.path, error))?;
        if self.synced.elapsed() > PATIENCE { self.sync() } else { Ok(()) }
    }

    /// What was appended is on the disk.
    pub(crate) fn sync(&mut self) -> Result<(), SweepError> {
        self.synced = Instant::now();
        self.file.sync_data().map_err(|error| SweepError::io("write", &self.path, error))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(x: f64) -> Row {
        Row { quantities: vec![x, -x], stopped: (x == 3.0).then(|| "it fell".to_string()) }
    }

    fn rows(folder: &Folder, members: u64) -> Result<Vec<Row>, SweepError> {
        let mut rows = Vec::new();
        folder.rows(members, |index, row| {
            assert_eq!(index, rows.len() as u64);
            rows.push(row);
            Ok(())
        })?;
        Ok(rows)
    }

    #[test]
    fn what_was_appended_is_there_whatever_was_torn() {
        let temporary = tempfile::tempdir().unwrap();
        let folder = Folder::beside(&temporary.path().join("table.csv"), 2);
        let identity = Identity::new([("plan", "1".to_string())]);
        folder.open(&identity).unwrap();
        let mut journal = folder.journal(0, 1).unwrap();
        journal.append(2, &[row(2.0), row(3.0)]).unwrap();
        journal.append(0, &[row(0.0)]).unwrap();
        assert_eq!(folder.missing(0..5).unwrap(), [1..2, 4..5]);
        assert_eq!(folder.missing(0..1).unwrap(), []);
        assert!(matches!(rows(&folder, 4), Err(SweepError::Missing { first: 1, last: 1 })));
        assert!(matches!(folder.journal(0, 1), Err(SweepError::Busy { .. })));
        drop(journal);
        // Every length of what was being written when the power failed.
        let path = folder.path().join("rows-0-of-1");
        let whole = fs::read(&path).unwrap();
        let first = 16 + 2 * (16 + 2) + "it fell".len() + 4;
        for length in 0..=whole.len() {
            fs::write(&path, &whole[..length]).unwrap();
            let expected = match length {
                _ if length < first => 0..4,
                _ if length < whole.len() => 0..2,
                _ => 1..2,
            };
            let missing = folder.missing(0..4).unwrap();
            assert_eq!((missing.len(), &missing[0]), (1, &expected), "{length}");
        }
        // A bit that fell over.
        let mut flipped = whole.clone();
        flipped[first + 20] ^= 1;
        fs::write(&path, flipped).unwrap();
        let mut journal = folder.journal(0, 1).unwrap();
        assert_eq!(fs::metadata(&path).unwrap().len(), first as u64);
        journal.append(0, &[row(0.0), row(1.0)]).unwrap();
        folder.journal(1, 2).unwrap().append(1, &[row(1.0), row(2.0)]).unwrap();
        assert_eq!(rows(&folder, 4).unwrap(), [0.0, 1.0, 2.0, 3.0].map(row));
        assert_eq!(rows(&folder, 3).unwrap().len(), 3);

        let changed = folder.open(&Identity::new([("plan", "2".to_string())])).unwrap_err();
        assert!(changed.to_string().contains("the plan has changed"), "{changed}");
        folder.open(&identity).unwrap();
        drop(journal);
        folder.remove().unwrap();
        assert!(!folder.path().exists());
    }
}
