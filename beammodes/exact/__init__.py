"""The Euler-Bernoulli beam itself, the judge: it knows nothing of chains."""
