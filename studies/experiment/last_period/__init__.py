"""Why p10 was the last period of the letter.

There is no `model`: each part is a question of its own, with its own equations.

`changes`   how do period and fold change with each parameter of the scene?
`causes`    which causes can turn p11 into p10, and at which excess?
`pairs`     at which free periods are the six printed pairs of frequency and period born?
`clouds`    up to which period do the strobe points stay apart in noise of the drive?
"""
