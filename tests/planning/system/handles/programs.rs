//! Programs of systems stated by handles.
