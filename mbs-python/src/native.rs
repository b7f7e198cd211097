//! Where compiled functions are kept, and by which compilers they are made.

use std::env;
use std::ffi::OsString;
use std::path::PathBuf;

use mbs_derive::optimise::Derivation;
use mbs_native::{Compilers, Library};

/// All functions of a mechanism that C has, compiled; the reason where there is no compiler or no folder.
pub(crate) fn library(derivation: &Derivation) -> Result<Library, String> {
    let folder = folder()?;
    Library::compiled(derivation, &Compilers::of_environment(), &folder, |_| true).map_err(|error| error.to_string())
}

/// Compilers' files, their commands, and the folder of what they make.
pub(crate) type Surroundings = (Vec<PathBuf>, Compilers, Option<OsString>);

/// What decides how functions are compiled: the compilers, and the folder that is asked for.
pub(crate) fn surroundings() -> Surroundings {
    let compilers = Compilers::of_environment();
    (compilers.found(), compilers, env::var_os("MBS_CACHE_DIR"))
}

/// `MBS_CACHE_DIR`, or the user's cache folder; in it `mbs/python`.
fn folder() -> Result<PathBuf, String> {
    let named = env::var_os("MBS_CACHE_DIR").filter(|name| !name.is_empty()).map(PathBuf::from);
    let cache = || env::var_os("XDG_CACHE_HOME").filter(|name| !name.is_empty()).map(PathBuf::from);
    let home = || env::var_os("HOME").filter(|name| !name.is_empty()).map(|home| PathBuf::from(home).join(".cache"));
    let beside = named.or_else(cache).or_else(home).ok_or("no folder to keep compiled code in: set MBS_CACHE_DIR")?;
    Ok(beside.join("mbs").join("python"))
}
