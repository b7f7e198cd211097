//! What earlier calls have derived, in the user's cache folder.
//!
//! An entry is a file: a digest of all that follows in it and of its key, then a value as postcard writes it. Its name
//! is its key, the digest of what the value was made from: the texts of a mechanism and of all that it imports, as they
//! are called in reports, what was asked for, and this program. So entries are never out of date; the ones that were
//! not used for longest go when there are too many.
//!
//! A cache that cannot be read or written is none: nothing here fails.

use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use mbs_derive::Digest;
use mbs_derive::source::Sources;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// The folder, where it is not the user's; empty for none.
const FOLDER: &str = "MBS_CACHE_DIR";

/// All entries together, in bytes.
const CAPACITY: u64 = 256 << 20;

/// How the names of entries end; files of other names are never touched.
const EXTENSION: &str = "mbs-cache";

/// Unfinished entries of processes that have ended are older.
const UNFINISHED: Duration = Duration::from_secs(3600);

/// A folder of entries, or none.
pub(crate) struct Cache {
    folder: Option<PathBuf>,
    capacity: u64,
}

impl Cache {
    /// The user's; none where the system has no such folder, or where this program cannot tell itself from
    /// another version.
    pub(crate) fn of_user() -> Self {
        let folder = match std::env::var_os(FOLDER) {
            Some(folder) => Some(PathBuf::from(folder)).filter(|folder| !folder.as_os_str().is_empty()),
            None => dirs::cache_dir().map(|folder| folder.join("mbs")),
        };
        let is_known = Digest::of_this_program().is_some();
        Cache { folder: folder.filter(|_| is_known), capacity: CAPACITY }
    }

    /// None: everything is made anew.
    pub(crate) fn none() -> Self {
        Cache { folder: None, capacity: 0 }
    }

    /// Where it is, if it is anywhere.
    pub(crate) fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    /// Where what is asked for of these texts is kept, or would be.
    pub(crate) fn path(&self, what: &str, sources: &Sources) -> Option<PathBuf> {
        self.folder.as_ref().map(|folder| folder.join(file_name(Digest::of_request(what, sources))))
    }

    /// What was kept of these texts, or else what is made now, which is kept unless it fails. Without a folder nothing
    /// is digested.
    pub(crate) fn or_make<T: Serialize + DeserializeOwned, E>(
        &self,
        what: &str,
        sources: &Sources,
        make: impl FnOnce() -> Result<T, E>,
    ) -> Result<T, E> {
        let Some(folder) = &self.folder else { return make() };
        let key = Digest::of_request(what, sources);
        if let Some(value) = self.get(folder, key) {
            return Ok(value);
        }
        let value = make()?;
        // Without room or permission it is made again next time.
        let _ = self.put(folder, key, &value);
        Ok(value)
    }

    /// An entry that is whole; it counts as used now.
    fn get<T: DeserializeOwned>(&self, folder: &Path, key: Digest) -> Option<T> {
        let path = folder.join(file_name(key));
        // To open a pipe would wait for its other end.
        fs::metadata(&path).ok().filter(|there| there.is_file())?;
        let mut bytes = Vec::new();
        File::open(&path).ok()?.take(self.capacity + 1).read_to_end(&mut bytes).ok()?;
        let (sum, content) = bytes.split_first_chunk::<16>()?;
        if *sum != sum_of(key, content) {
            return None;
        }
        let value = postcard::from_bytes(content).ok()?;
        let _ = File::options().append(true).open(&path).and_then(|file| file.set_modified(SystemTime::now()));
        Some(value)
    }

    /// Writes an entry beside its place and moves it there: others see it whole, or not at all.
    fn put<T: Serialize>(&self, folder: &Path, key: Digest, value: &T) -> io::Result<()> {
        let content = postcard::to_allocvec(value).map_err(io::Error::other)?;
        let sum = sum_of(key, &content);
        if (sum.len() + content.len()) as u64 > self.capacity {
            return Ok(());
        }
        fs::create_dir_all(folder)?;
        let mut file = tempfile::Builder::new().suffix(&format!(".{EXTENSION}")).tempfile_in(folder)?;
        file.write_all(&sum)?;
        file.write_all(&content)?;
        file.persist(folder.join(file_name(key))).map_err(|error| error.error)?;
        self.make_room(folder)
    }

    /// Removes what was not used for longest until the rest is small enough, and what was left unfinished.
    fn make_room(&self, folder: &Path) -> io::Result<()> {
        let mut entries: Vec<(SystemTime, u64, PathBuf)> = Vec::new();
        for entry in fs::read_dir(folder)? {
            let path = entry?.path();
            if path.extension().is_none_or(|extension| extension != EXTENSION) {
                continue;
            }
            // Others may have removed it by now.
            let Ok(there) = fs::symlink_metadata(&path) else { continue };
            let used = there.modified()?;
            let is_unfinished = path.file_stem().is_none_or(|name| name.len() != 2 * size_of::<Digest>());
            if is_unfinished && used.elapsed().is_ok_and(|age| age > UNFINISHED) {
                let _ = fs::remove_file(&path);
            } else if !is_unfinished && there.is_file() {
                entries.push((used, there.len(), path));
            }
        }
        entries.sort();
        let mut size: u64 = entries.iter().map(|(_, length, _)| length).sum();
        for (_, length, path) in entries {
            if size <= self.capacity {
                break;
            }
            let _ = fs::remove_file(path);
            size -= length;
        }
        Ok(())
    }
}

fn file_name(key: Digest) -> String {
    format!("{key}.{EXTENSION}")
}

fn sum_of(key: Digest, content: &[u8]) -> [u8; 16] {
    Digest::of([&key.bytes()[..], content]).bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts() -> Sources {
        Sources::new("m.mbs", "mechanism M { }")
    }

    fn cache(capacity: u64) -> (tempfile::TempDir, Cache) {
        let folder = tempfile::tempdir().unwrap();
        let cache = Cache { folder: Some(folder.path().join("mbs")), capacity };
        (folder, cache)
    }

    /// Whether it is made now, and what it is.
    fn take(cache: &Cache, what: &str, value: &str) -> (bool, String) {
        let mut made = false;
        let make = || {
            made = true;
            Ok::<_, ()>(value.to_string())
        };
        let value = cache.or_make(what, &texts(), make).unwrap();
        (made, value)
    }

    #[test]
    fn what_was_made_is_kept_unless_it_failed() {
        let (_folder, cache) = cache(1000);
        assert_eq!(cache.or_make::<String, _>("a", &texts(), || Err("no")), Err("no"));
        assert_eq!(take(&cache, "a", "one"), (true, "one".to_string()));
        assert_eq!(take(&cache, "a", "two"), (false, "one".to_string()));
        assert_eq!(take(&cache, "b", "two"), (true, "two".to_string()));
        assert_eq!(take(&Cache::none(), "a", "three"), (true, "three".to_string()));
    }

    #[test]
    fn a_damaged_entry_is_made_again() {
        let (_folder, cache) = cache(1000);
        let key = "a";
        take(&cache, key, "one");
        let path = cache.path(key, &texts()).unwrap();
        let whole = fs::read(&path).unwrap();
        let flipped = (0..8 * whole.len()).map(|bit| {
            let mut bytes = whole.clone();
            bytes[bit / 8] ^= 1 << (bit % 8);
            bytes
        });
        let cut = (0..whole.len()).map(|length| whole[..length].to_vec());
        let longer = [[&whole[..], b"x"].concat()];
        for bytes in flipped.chain(cut).chain(longer) {
            fs::write(&path, bytes).unwrap();
            assert_eq!(take(&cache, key, "two"), (true, "two".to_string()));
        }
        assert_eq!(take(&cache, key, "three"), (false, "two".to_string()));
    }

    #[test]
    fn an_entry_under_the_name_of_another_is_damaged() {
        let (_folder, cache) = cache(1000);
        take(&cache, "a", "one");
        fs::rename(cache.path("a", &texts()).unwrap(), cache.path("b", &texts()).unwrap()).unwrap();
        assert_eq!(take(&cache, "b", "two"), (true, "two".to_string()));
    }

    #[test]
    fn what_was_not_used_for_longest_goes() {
        let entry = 16 + 101;
        let (_folder, cache) = cache(2 * entry);
        let value = "x".repeat(100);
        let age = |text: &str, seconds| {
            let file = File::options().append(true).open(cache.path(text, &texts()).unwrap()).unwrap();
            file.set_modified(SystemTime::now() - Duration::from_secs(seconds)).unwrap();
        };
        let is_there = |text: &str| cache.path(text, &texts()).unwrap().exists();
        take(&cache, "a", &value);
        take(&cache, "b", &value);
        age("a", 20);
        age("b", 10);
        assert!(!take(&cache, "a", &value).0, "used, so that `b` goes first");
        take(&cache, "c", &value);
        assert_eq!(["a", "b", "c"].map(is_there), [true, false, true]);
        take(&cache, "d", &value.repeat(3));
        assert!(!is_there("d"), "larger than all that may be kept");
    }

    #[test]
    fn only_its_own_files_are_removed() {
        let (_folder, cache) = cache(200);
        let folder = cache.folder.clone().unwrap();
        fs::create_dir_all(&folder).unwrap();
        let (foreign, unfinished) = (folder.join("thesis.tex"), folder.join(".tmpabc.mbs-cache"));
        for path in [&foreign, &unfinished] {
            fs::write(path, [0; 1000]).unwrap();
            File::options().append(true).open(path).unwrap().set_modified(SystemTime::UNIX_EPOCH).unwrap();
        }
        take(&cache, "a", "one");
        assert!(foreign.exists() && !unfinished.exists());
        assert!(!take(&cache, "a", "one").0);
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_no_error() {
        let folder = tempfile::tempdir().unwrap();
        fs::write(folder.path().join("mbs"), "a file").unwrap();
        let cache = Cache { folder: Some(folder.path().join("mbs")), capacity: 1000 };
        for _ in 0..2 {
            assert_eq!(take(&cache, "a", "one"), (true, "one".to_string()));
        }
    }
}
