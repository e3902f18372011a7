//! Sets that are joined: the connected parts of a graph.

/// A partition of numbers into sets, each with its smallest number as the root.
#[derive(Debug, Clone)]
pub struct UnionFind {
    parent: Vec<usize>,
}

impl UnionFind {
    /// So many sets of one number each.
    pub fn new(count: usize) -> Self {
        UnionFind { parent: (0..count).collect() }
    }

    /// The root of a number's set.
    pub fn root(&mut self, mut k: usize) -> usize {
        while self.parent[k] != k {
            self.parent[k] = self.parent[self.parent[k]];
            k = self.parent[k];
        }
        k
    }

    /// Joins the sets of two numbers.
    pub fn join(&mut self, a: usize, b: usize) {
        let (a, b) = (self.root(a), self.root(b));
        self.parent[a.max(b)] = a.min(b);
    }
}
