"""Activated aluminium decays: counts of 10 s, in thousands, corrected for dead time, every 51.4 s.

20 min are learned, the next 10 min are unseen. Every fifth spectrum of the source is read.
"""

import numpy as np

REPOSITORY = "Nhlanhlajunior100/Half-Life-Experiment"
COMMIT = "83eb3275875f322273b123c936d19c950c292aed"
HASHES = """
7250a701a23deeedc578b6e4ecfd433f28c6bbab76c48ffe4cf6f2752b54d8ec
39bfc1e60fe26ad98b732f2f8b9b0d96d5e8322d61e3495883f3484d447fb9ce
a4db0dbbc5cacfa60503d5073ad644ddcb1cc27d07a7e44e8d3f29daff68de56
867e172a42987fd44011356c7be39e7cb3d7f0155015bd307f321c699030e30e
c91cde0a965002d65a3e27f4e9eaedc5525e46f85f6772325a32f22ae5d7ab77
d3ff9b0b8b46b5955abca6a6e8d6cfbf0d5be18a25a532ed28ed63185ed9a864
d81103bb8c6befdf1bdfc103da70622aecfc278d97fa7e5adab85f0c023620ae
28e62745614901a23d21c85073101db0a4720b57c43c3e1fd49ca9bbd7975035
0ab3a256cdb04d35a94e60ab8b2d837263d7d8846cbb72110eb1b36d49353126
06934b67e13ff47923e79558082702c610771e867369cbc322fe0c7b41547190
8885944d1c0284eb6bd519a4fd973a408f74b0d1219c6e6a5f17c009705491de
cca4f7e3391b79912313e9e848794a4ce6b77d63087d9cc44e6e1ac9666bb577
7530c0d21e93aa59e4e257fde7cdad4251ada1a350b769e322076cdfade3aec8
34ba4d847466c0fdee2140e359160c0d36c209f0c07b3d995aa4f75e5eb34554
c4954427cb9db8889933dd7fc14b90b89f3f3a903c62ba881431d5aa98717dcd
c4f8116fa9a87a1990f6dcb8acf102314123082822dbab1f847265ebb08dda0e
69628ee701499da3d61b5b2d72858597034e909760d5390e91bd912b01a1d902
71b63551d46443686c31ab02e79d0b18b90ea0f519605e8c11c62b5f533aafcf
8d578fad5327df35152a901871b2d68fae52d70594965545686d0caae6d4001c
c16e8a21b08dc68fef61c98e6c1602f6df444afc5baf31cb4417464c1979fe92
439ccef6d902c85d084e108d1811016bdb437f00bdf961ff7da0ae4622fc1cd8
5fe2dedfa3616fac9677dcc51ad0953dea4c48a92ecdd0ef5b0ee43d7cfa43a3
5cd3611933ff79966a548af217b2f31ef705750f176c4b102b3f377e41d84342
ad77ebd4e1916c83d4532c524d0dfd6c6a845db428e7c73f69e710e05b30e400
3cb1ba6573b76e19558d4d3e62bea2fd2779289838e196abaf1246f1491a3501
295c3fc349dbe133bc73ebc5efdbd36fdebd5f3dd869c1557c4fa948c198d7f5
9efcce657533d1bc359c6a792fea7a43875f27d7a83d79ed1ad0323e8352c4bf
d5586853a09b73c08ebedaf2830b8324df109db5e4c207a0be7aa735eddac618
a56995affcff45a2dbef92e6336eaa17e8dd4b2fc74e6757c2aa5792bfc6888b
eccca73501a62bf4e7de5df3e3a40ee64e8ebff581f01270e8c85ee5e4ad3844
605c7c5aaa1fa3fa4f101d3782c9f99fbcade87c09bfdcb01adeaf4e5186c75d
3606b8f6ebf727b7ec77b3b534b9e091eb8593315a3377adc2b740f798adcc84
c6298c215c2cb01640dc265e1ef8a4e2a715abf962df7dab55469b7024519ec7
3817862f39bb396ab9e5341d052e1650da6e54aac62a49369b8e0727488d543e
21f447c57262dee7265c473d1bf6c657d293f042f8e57dc8bc0100a4d4391127
34f9f013e17be703cafb7ade50a9d51c372858d2f078e7a3ba05d5647b036b32
"""
FILES = {f"Data/AluminiumData_{k}.tsv": found for k, found in zip(range(1, 181, 5), HASHES.split(), strict=True)}


def read_trials(files):
    """Learned and unseen trials."""
    counts = []
    for content in files.values():
        head, spectrum = content.decode("latin-1").split("Counts")
        live = float(head.split("Elapsed Live Time:")[1].split()[0])
        counts.append(sum(int(line.split()[-1]) for line in spectrum.splitlines() if line.strip()) / live / 100)
    sample = {"time": np.arange(36) * 51.37, "counts": np.array(counts)}
    return [{k: v[:24] for k, v in sample.items()}], [{k: v[24:] for k, v in sample.items()}]
