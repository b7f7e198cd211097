//! The processes that MPI's launcher has started, where this program is built with its feature `mpi`.

#[cfg(feature = "mpi")]
pub(super) use joined::Ranks;
#[cfg(not(feature = "mpi"))]
pub(super) use none::Ranks;

#[cfg(feature = "mpi")]
mod joined {
    use mbs_ensemble::Share;
    use mpi::environment::Universe;
    use mpi::traits::{Communicator, CommunicatorCollectives};

    /// All processes, of which this is one.
    pub(in super::super) struct Ranks(Universe);

    impl Ranks {
        /// Those of the launcher, if it has started more than one: `mpirun`, or another that says so in the
        /// environment.
        pub(in super::super) fn joined() -> Option<Self> {
            let is_launched =
                Share::launched(|name| std::env::var(name).ok()).is_some_and(|Share { ranks, .. }| ranks > 1);
            is_launched.then(mpi::initialize).flatten().map(Ranks)
        }

        /// What this process does.
        pub(in super::super) fn share(&self) -> Share {
            let world = self.0.world();
            Share { rank: world.rank().unsigned_abs().into(), ranks: world.size().unsigned_abs().into() }
        }

        /// Waits until all ranks are here.
        pub(in super::super) fn wait(&self) {
            self.0.world().barrier();
        }

        /// Ends all ranks: others would wait for this one for ever.
        pub(in super::super) fn abort(&self) -> ! {
            self.0.world().abort(1)
        }
    }
}

#[cfg(not(feature = "mpi"))]
mod none {
    use mbs_ensemble::Share;

    /// None of them: there is no value of this type.
    pub(in super::super) enum Ranks {}

    impl Ranks {
        pub(in super::super) fn joined() -> Option<Self> {
            None
        }

        pub(in super::super) fn share(&self) -> Share {
            match *self {}
        }

        pub(in super::super) fn wait(&self) {
            match *self {}
        }

        pub(in super::super) fn abort(&self) -> ! {
            match *self {}
        }
    }
}
