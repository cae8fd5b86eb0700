//! Where pictures that are worth it are kept from run to run.

use clap::Args;
use cube3_method::Cache;
use std::env::var_os;
use std::path::PathBuf;

/// Arguments of commands that keep pictures.
#[derive(Debug, Args)]
pub struct CacheArguments {
    /// Where pictures of slow methods are kept, to be found again by what they were made of; $CUBE3_CACHE without it, or cube3 in the user's
    /// folder of caches.
    #[arg(long, value_name = "DIR", conflicts_with = "no_cache")]
    cache: Option<PathBuf>,
    /// Keep no picture and look for none.
    #[arg(long)]
    no_cache: bool,
}

impl CacheArguments {
    /// The folder that is meant; none where none is wanted, or the system names none.
    pub fn cache(&self) -> Option<Cache> {
        let set = |name: &str| var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
        let users = || {
            let caches = set("XDG_CACHE_HOME").or_else(|| Some(set("HOME")?.join(".cache")));
            Some(caches?.join("cube3"))
        };
        let folder = self.cache.clone().or_else(|| set("CUBE3_CACHE")).or_else(users);
        folder.filter(|_| !self.no_cache).map(Cache::at)
    }
}
